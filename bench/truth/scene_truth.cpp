// SPDX-License-Identifier: BSD-3-Clause
// Reconstruction between the samples, against exact truth: every simulated scene is scanned with
// noise, coded by the paper's profile and reconstructed denser; each interpolated point (one that
// lies on no coded cell) is compared with the surface that its own ray meets.  Usage: scene_truth
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "curlidar/codec.hpp"
#include "curlidar/simulate.hpp"

namespace {

using namespace curlidar;

/// A scene with the sensor and the preset that people would take into it.
struct Case {
  const char* scene;
  const char* sensor;
  const char* preset;
};
constexpr Case kCases[] = {{"street", "hdl64e-kitti", "outdoor"},
                           {"forest", "hdl64e-kitti", "outdoor"},
                           {"newer-college", "os1-64-gen1", "newer-college"},
                           {"room", "os1-64-gen1", "indoor"},
                           {"corridor", "os1-64-gen1", "indoor"}};

struct Errors {
  std::vector<double> range_m;  ///< |reconstructed - true| along the ray
  std::size_t sky = 0;          ///< points where the ray meets nothing
};

bool on_cell(double index) {
  return std::abs(index - std::round(index)) < 1e-9;
}

Errors interpolated_errors(const Scene& scene, const DecodedScan& scan, double rows) {
  const Lattice& lattice = scan.field->lattice();
  const DenseGrid grid(lattice, rows, 1);
  const Cloud cloud = reconstruct(scan, {.rows = rows, .organised = true, .threads = 0}).value();
  Errors errors;
  for (std::size_t i = 0; i < grid.rows; ++i) {
    if (on_cell(grid.row(i))) continue;
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const Vec3& p = cloud.positions[i * grid.columns + j];
      if (!is_return(p)) continue;
      Hit hit;
      if (scene.cast({}, lattice.direction(grid.row(i), grid.column(j)), hit)) {
        errors.range_m.push_back(std::abs(norm(p) - hit.range_m));
      } else {
        ++errors.sky;
      }
    }
  }
  return errors;
}

void print_row(const Case& c, const PaperSettings& paper, const EncodeReport& report, double rows,
               Errors errors) {
  double sum = 0, close = 0;
  for (const double e : errors.range_m) {
    sum += e;
    close += e < 0.05 ? 1 : 0;
  }
  const double n = static_cast<double>(std::max<std::size_t>(errors.range_m.size(), 1));
  fmt::print(
      "| {} | {} | {} | {}x{} | {:.1f} | {:g}x1 | {} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | {} |\n",
      c.scene, c.sensor, c.preset, paper.upsample_rows, paper.upsample_columns,
      report.cp_paper_percent, rows, errors.range_m.size(), sum / n,
      percentile(errors.range_m, 0.5), percentile(errors.range_m, 0.95), 100 * close / n,
      errors.sky);
}

}  // namespace

int main() {
  fmt::print(
      "Errors of interpolated points along their rays, metres. sky: points where there is "
      "no surface.\n\n| scene | sensor | preset | S | CP % | R | points | mean | median | "
      "p95 | within 5 cm % | sky |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Case& c : kCases) {
    const auto scene = make_scene(c.scene).value();
    const SensorProfile sensor = builtin_sensor(c.sensor).value();
    const Cloud scan = simulate(*scene, sensor, {.threads = 0}).value();
    for (const auto& [rows, columns] : {std::pair{1u, 1u}, {2u, 1u}, {2u, 2u}}) {
      EncodeSettings settings;
      settings.profile = Profile::paper;
      settings.sensor = sensor;
      settings.attributes.emplace();
      settings.threads = 0;
      settings.paper = paper_preset(c.preset).value();
      settings.paper.upsample_rows = rows;
      settings.paper.upsample_columns = columns;
      const Encoded encoded = encode(scan, settings).value();
      const DecodedScan decoded = decode(encoded.bytes).value();
      for (const double factor : {2.0, 4.0, 8.0}) {
        print_row(c, settings.paper, encoded.report, factor,
                  interpolated_errors(*scene, decoded, factor));
      }
    }
  }
  return 0;
}
