// SPDX-License-Identifier: BSD-3-Clause
// The paper profiles beside the reference figures: the authors' own C++ core run end to end on one
// KITTI scan (odometry 07/0 as shipped with their code, 122,627 points). Prints one row for each
// configuration and whether both directed mean errors and the compression percentage stay within
// 5 % of the reference.  Usage: paper_parity SCAN [--quick]
#include <cstdio>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "curlidar/reconstruct.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/io.hpp"
#include "report/measure/inputs.hpp"

namespace {

using namespace curlidar;
using bench::gridded;
using bench::in_range;

constexpr double kTolerance = 1.05;

/// Mean error of the reference, metres, in both directions, at one density.
struct ReferenceDensity {
  double rows, columns;
  double to_original, to_reconstructed;
};

struct Reference {
  const char* name;
  Profile profile;
  std::uint32_t patch;
  double cp_percent;
  std::vector<ReferenceDensity> densities;
};

const std::vector<Reference> kReferences{
    {"default P_r 4",
     Profile::paper,
     4,
     15.21,
     {{1, 1, .0562, .0735},
      {2, 1, .0743, .0689},
      {4, 1, .0741, .0631},
      {6, 1, 0, 0},
      {8, 1, .0741, .0593},
      {8, 2, .0756, .0563}}},
    {"default P_r 2", Profile::paper, 2, 44.64, {{1, 1, .0439, .0529}}},
    {"default P_r 8", Profile::paper, 8, 7.08, {{1, 1, .0671, .0983}}},
    {"1:1-tuned P_r 4", Profile::paper_1to1, 4, 34.30, {{1, 1, .0033, .0079}}},
    {"1:1-tuned P_r 2", Profile::paper_1to1, 2, 51.58, {{1, 1, .0020, .0020}}},
    {"baseline, degree 64", Profile::paper_global, 4, 7.50, {{1, 1, .083, .124}}},
};

/// A figure of the reference, "-" where it has none.
std::string known(double reference) {
  return reference == 0 ? "-" : fmt::format("{:.4f}", reference);
}

std::string verdict(double ours, double reference) {
  if (reference == 0) return "-";
  return ours <= reference * kTolerance ? "yes" : "NO";
}

bool print_densities(const Reference& reference, const DecodedScan& decoded, const Cloud& original,
                     const Cloud& raw) {
  bool holds = true;
  for (const ReferenceDensity& density : reference.densities) {
    const Result<Cloud> cloud =
        reconstruct(decoded, {.rows = density.rows, .columns = density.columns});
    if (!cloud) return false;
    const Result<Comparison> near = compare(*cloud, original);
    const Result<Comparison> far = compare(*cloud, raw);
    if (!near || !far) return false;
    const std::string a = verdict(near->a_to_b.mean, density.to_original);
    const std::string b = verdict(near->b_to_a.mean, density.to_reconstructed);
    holds = holds && a != "NO" && b != "NO";
    fmt::print(
        "| {}, {}x{} | {} | {:.4f} / {:.4f} / {:.3f} | {} | {} | {:.4f} / {:.4f} / {:.3f} | {} | "
        "{} "
        "| {:.4f} | {:.4f} |\n",
        reference.name, density.rows, density.columns, cloud->size(), near->a_to_b.mean,
        near->a_to_b.std, near->a_to_b.p95, known(density.to_original), a, near->b_to_a.mean,
        near->b_to_a.std, near->b_to_a.p95, known(density.to_reconstructed), b, far->a_to_b.mean,
        far->b_to_a.mean);
  }
  return holds;
}

int fail(const Error& error) {
  fmt::print(stderr, "paper_parity: {}\n", error.message);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: paper_parity SCAN [--quick]\n");
    return 2;
  }
  const bool quick = argc > 2 && std::string_view(argv[2]) == "--quick";
  const Result<Cloud> scan = read_cloud(argv[1]);
  if (!scan) return fail(scan.error());
  EncodeSettings settings;
  Result<SensorProfile> sensor = builtin_sensor("hdl64e-kitti");
  if (!sensor) return fail(sensor.error());
  settings.sensor = *sensor;
  settings.attributes.emplace();
  settings.threads = 1;
  const Result<Cloud> original = gridded(*scan, settings);
  if (!original) return fail(original.error());

  fmt::print(
      "Distances in metres: mean / std / p95; 'ref' is the reference's mean, 'ok' whether "
      "ours is within 5 %; raw: the raw returns within the range limits.\n\n");
  fmt::print(
      "| configuration, R | points | recon -> grid | ref | ok | grid -> recon | ref | ok "
      "| recon -> raw | raw -> recon |\n|---|---|---|---|---|---|---|---|---|---|\n");
  bool holds = true;
  std::string sizes;
  for (const Reference& reference : kReferences) {
    if (quick && reference.profile == Profile::paper_global) continue;
    settings.profile = reference.profile;
    settings.paper = for_profile({}, reference.profile);
    settings.paper.patch = reference.patch;
    const std::clock_t begin = std::clock();
    const Result<Encoded> encoded = encode(*scan, settings);
    const double cpu_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    if (!encoded) return fail(encoded.error());
    const Result<DecodedScan> decoded = decode(encoded->bytes);
    if (!decoded) return fail(decoded.error());
    holds =
        print_densities(reference, *decoded, *original, in_range(*scan, *decoded->paper)) && holds;
    const EncodeReport& r = encoded->report;
    const std::string ok = verdict(r.cp_paper_percent, reference.cp_percent);
    holds = holds && ok != "NO";
    std::string degrees, stages;
    for (std::size_t d = 1; d < r.degrees.size(); ++d) {
      degrees += fmt::format("{}{}", d > 1 ? ":" : "", r.degrees[d]);
    }
    for (const StageTime& s : r.stages_ms) stages += fmt::format("{} {:.0f}, ", s.stage, s.ms);
    sizes += fmt::format(
        "| {} | {:.2f} | {:.2f} | {} | {} | {} | {} | {} | {} | {} | {:.2f} | {}CPU in all {:.0f} "
        "|\n",
        reference.name, r.cp_paper_percent, reference.cp_percent, ok, r.coefficients, r.patches,
        degrees, r.projection.kept, r.points_upsampled, r.bytes, r.bits_per_point, stages, cpu_ms);
  }
  fmt::print(
      "\n| configuration | CP % | ref | ok | coefficients | patches | degrees 1:2:.. | gridded | "
      "upsampled | "
      "bytes | bits a raw point | stages ms, one thread "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n{}\n{}\n",
      sizes, holds ? "parity holds" : "PARITY FAILS");
  return holds ? 0 : 1;
}
