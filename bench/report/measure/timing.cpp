// SPDX-License-Identifier: BSD-3-Clause
// The paper's tables of time: its 1:1-tuned codec beside PCL's octree, and its default codec stage
// by stage; with the compact codec and a copy of the cloud for scale. CPU milliseconds on one
// thread, medians over the runs of this process.
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/try.hpp"
#include "curlidar/reconstruct.hpp"
#include "peers/pcl_profiles.hpp"
#include "peers/peers.hpp"
#include "report/measure/codecs.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/json.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

/// Milliseconds of each stage, run after run.
using Laps = std::map<std::string, std::vector<double>>;

double median_of(std::vector<double> values) {
  return percentile(values, 0.5);
}

/// Encodes and notes what each stage took: the codec reports them as they end.
Result<Encoded> timed_encode(const Cloud& cloud, const EncodeSettings& settings, Laps& laps) {
  std::map<std::string, double> stages;
  CpuTimer lap, whole;
  Result<Encoded> encoded = encode(cloud, settings, [&](std::string_view stage, double) {
    stages[std::string(stage)] += lap.lap_ms();
  });
  laps["encode"].push_back(whole.lap_ms());
  for (const auto& [stage, ms] : stages) laps[stage].push_back(ms);
  return encoded;
}

void print_codec(const std::string& codec, const std::string& setting, const Laps& laps,
                 const std::vector<std::string>& names) {
  Json line{{"kind", "codec"}, {"codec", codec}, {"setting", setting}};
  for (const std::string& name : names) line[name + "_ms"] = median_of(laps.at(name));
  print_line(line);
}

/// What one codec takes to turn a cloud into bytes and back.
Status time_codec(const std::string& codec, const std::string& setting, const Cloud& cloud,
                  const EncodeSettings& settings, std::uint32_t runs) {
  Laps laps;
  for (std::uint32_t run = 0; run < runs; ++run) {
    CURLIDAR_TRY_ASSIGN(encoded, timed_encode(cloud, settings, laps));
    CpuTimer timer;
    CURLIDAR_TRY_ASSIGN(decoded, decode(encoded.bytes));
    CURLIDAR_TRY_ASSIGN(back, reconstruct(decoded));
    laps["decode"].push_back(timer.lap_ms());
    // What precedes the fit: the other codecs are given the gridded cloud.
    const auto lap = [&](const char* stage) {
      return laps.contains(stage) ? laps[stage].back() : 0.0;
    };
    const double gridding = lap("outliers") + lap("project");
    laps["encode_grid"].push_back(laps["encode"].back() - gridding);
  }
  print_codec(codec, setting, laps, {"encode", "encode_grid", "decode"});
  return {};
}

void time_pcl([[maybe_unused]] const Cloud& grid, [[maybe_unused]] std::uint32_t runs) {
  for (std::size_t profile = 0; profile < kPclProfiles.size(); ++profile) {
#ifdef CURLIDAR_BENCH_HAS_PCL
    Laps laps;
    for (std::uint32_t run = 0; run < runs; ++run) {
      const PclStream stream = pcl_encode(grid, profile);
      laps["encode"].push_back(stream.encode_ms);
      laps["decode"].push_back(pcl_decode(stream, profile).decode_ms);
    }
    laps["encode_grid"] = laps["encode"];
    print_codec("pcl", kPclProfiles[profile], laps, {"encode", "encode_grid", "decode"});
#else
    print_line({{"kind", "codec"},
                {"codec", "pcl"},
                {"setting", kPclProfiles[profile]},
                {"skipped", kNoPcl}});
#endif
  }
}

/// The paper's default codec: upsampling (mesh and rays), extraction (the fit), reconstruction.
Status time_stages(const Scan& scan, std::uint32_t runs) {
  Laps laps;
  std::map<int, std::size_t> points;
  for (std::uint32_t run = 0; run < runs; ++run) {
    CURLIDAR_TRY_ASSIGN(encoded, timed_encode(scan.cloud, scan.settings, laps));
    laps["upsampling"].push_back(laps["mesh"].back() + laps["upsample"].back());
    CpuTimer timer;
    CURLIDAR_TRY_ASSIGN(decoded, decode(encoded.bytes));
    laps["parse"].push_back(timer.lap_ms());
    for (const int rows : {1, 2, 4, 6, 8}) {
      timer.lap_ms();
      CURLIDAR_TRY_ASSIGN(cloud, reconstruct(decoded, {.rows = static_cast<double>(rows)}));
      laps[fmt::format("reconstruct {}", rows)].push_back(timer.lap_ms());
      points[rows] = cloud.size();
    }
  }
  for (const auto& [name, stage] :
       {std::pair{"upsampling", "upsampling"}, {"fit", "extraction"}, {"parse", "decoding"}}) {
    print_line({{"kind", "stage"}, {"stage", stage}, {"ms", median_of(laps.at(name))}});
  }
  for (const auto& [rows, count] : points) {
    print_line({{"kind", "stage"},
                {"stage", "reconstruction"},
                {"factor", rows},
                {"points", count},
                {"ms", median_of(laps.at(fmt::format("reconstruct {}", rows)))}});
  }
  return {};
}

/// Copying the gridded cloud as float32 coordinates: what no codec can beat.
void time_copy(std::size_t points, std::uint32_t runs) {
  constexpr int kCopies = 200;  // in a run: one is too short for the clock
  const std::vector<float> from(3 * points, 1.0f);
  std::vector<float> to(from.size());
  volatile float seen = 0;  // or the compiler leaves the copies out
  std::vector<double> ms;
  for (std::uint32_t run = 0; run < runs; ++run) {
    CpuTimer timer;
    for (int copy = 0; copy < kCopies; ++copy) {
      std::memcpy(to.data(), from.data(), from.size() * sizeof(float));
      seen = to[static_cast<std::size_t>(copy) % to.size()];
    }
    ms.push_back(timer.lap_ms() / kCopies);
  }
  static_cast<void>(seen);
  print_line({{"kind", "copy"}, {"bytes", from.size() * sizeof(float)}, {"ms", median_of(ms)}});
}

}  // namespace

Status timing(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(runs, arguments.number("runs", 5, 1, 1000));
  CURLIDAR_TRY_ASSIGN(scan, read_scan(arguments));
  CURLIDAR_TRY_ASSIGN(grid, gridded(scan.cloud, scan.settings));
  const std::size_t points = count_returns(grid);
  print_line({{"kind", "input"},
              {"preset", scan.preset},
              {"runs", runs},
              {"returns", count_returns(scan.cloud)},
              {"grid_points", points}});
  CURLIDAR_TRY(time_codec("paper-1to1", paper_setting(Profile::paper_1to1), scan.cloud,
                          of_profile(scan.settings, Profile::paper_1to1), runs));
  time_pcl(grid, runs);
  constexpr double kError_m = 0.05;
  EncodeSettings compact = compact_of_image(kError_m);
  for (const std::uint32_t effort : {1u, compact.compact.effort}) {
    compact.compact.effort = effort;
    CURLIDAR_TRY(time_codec("compact",
                            fmt::format("{}, effort {}", error_setting(kError_m), effort), grid,
                            compact, runs));
  }
  CURLIDAR_TRY(time_stages(scan, runs));
  time_copy(points, runs);
  return {};
}

}  // namespace curlidar::bench
