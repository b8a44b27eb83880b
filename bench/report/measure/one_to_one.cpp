// SPDX-License-Identifier: BSD-3-Clause
// The paper's first table: its gridded cloud coded by every codec, errors in both directions
// against that cloud and against the raw returns within the range limits.
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/try.hpp"
#include "curlidar/reconstruct.hpp"
#include "peers/pcl_profiles.hpp"
#include "report/measure/codecs.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/json.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

/// What the codecs are measured against.
struct Originals {
  Cloud grid, raw;
  std::size_t points = 0;  ///< of the grid
};

/// What came of the gridded cloud.
struct Outcome {
  std::string codec, setting;
  std::size_t bytes = 0;
  std::optional<double> cp_paper_percent;  ///< where the paper defines one
  Cloud cloud;
};

/// Both directed statistics with their percentiles, under the names "to_X" and "from_X".
Status add_distances(const Cloud& cloud, const Cloud& original, const std::string& name,
                     Json& line) {
  CURLIDAR_TRY_ASSIGN(to, nearest_distances(cloud, original));
  CURLIDAR_TRY_ASSIGN(from, nearest_distances(original, cloud));
  line["to_" + name] = to_json(summarise(to));
  line["from_" + name] = to_json(summarise(from));
  line["to_" + name + "_percentiles"] = percentiles_of(std::move(to));
  line["from_" + name + "_percentiles"] = percentiles_of(std::move(from));
  return {};
}

Status print_outcome(const Outcome& outcome, const Originals& originals) {
  const double bytes = static_cast<double>(outcome.bytes);
  const double points = static_cast<double>(originals.points);
  constexpr double kFloat32 = 12, kFloat64 = 24;  // bytes of x, y and z
  Json line{{"codec", outcome.codec},
            {"setting", outcome.setting},
            {"points_in", originals.points},
            {"points_out", count_returns(outcome.cloud)},
            {"bytes", outcome.bytes},
            {"bits_per_point", 8 * bytes / points},
            {"percent_of_float32", 100 * bytes / (kFloat32 * points)},
            {"percent_of_float64", 100 * bytes / (kFloat64 * points)}};
  if (outcome.cp_paper_percent) line["cp_paper_percent"] = *outcome.cp_paper_percent;
  CURLIDAR_TRY(add_distances(outcome.cloud, originals.grid, "grid", line));
  CURLIDAR_TRY(add_distances(outcome.cloud, originals.raw, "raw", line));
  print_line(line);
  return {};
}

void print_skipped(const std::string& codec, const std::string& setting,
                   const std::string& reason) {
  print_line({{"codec", codec}, {"setting", setting}, {"skipped", reason}});
}

Result<Outcome> paper_outcome(const Scan& scan, Profile profile) {
  CURLIDAR_TRY_ASSIGN(encoded, encode(scan.cloud, of_profile(scan.settings, profile)));
  CURLIDAR_TRY_ASSIGN(decoded, decode(encoded.bytes));
  CURLIDAR_TRY_ASSIGN(cloud, reconstruct(decoded));
  return Outcome{to_string(profile), paper_setting(profile), encoded.bytes.size(),
                 encoded.report.cp_paper_percent, std::move(cloud)};
}

Result<Outcome> compact_outcome(const Cloud& grid, double error_m) {
  CURLIDAR_TRY_ASSIGN(encoded, encode(grid, compact_of_image(error_m)));
  CURLIDAR_TRY_ASSIGN(decoded, decode(encoded.bytes));
  CURLIDAR_TRY_ASSIGN(cloud, reconstruct(decoded));
  return Outcome{"compact", error_setting(error_m), encoded.bytes.size(), {}, std::move(cloud)};
}

#ifdef CURLIDAR_BENCH_HAS_PCL
/// Its percentage is that of PCL's own statistics: of coordinates as float32.
Outcome pcl_outcome(const Cloud& grid, std::size_t points, std::size_t profile) {
  const PclStream stream = pcl_encode(grid, profile);
  const double cp =
      100 * static_cast<double>(stream.bytes.size()) / (12.0 * static_cast<double>(points));
  return {"pcl", kPclProfiles[profile], stream.bytes.size(), cp, pcl_decode(stream, profile).cloud};
}
#endif

Status print_pcl([[maybe_unused]] const Originals& originals) {
  for (std::size_t profile = 0; profile < kPclProfiles.size(); ++profile) {
#ifdef CURLIDAR_BENCH_HAS_PCL
    CURLIDAR_TRY(print_outcome(pcl_outcome(originals.grid, originals.points, profile), originals));
#else
    print_skipped("pcl", kPclProfiles[profile], kNoPcl);
#endif
  }
  return {};
}

}  // namespace

Status one_to_one(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(scan, read_scan(arguments));
  Originals originals;
  Result<Cloud> grid = gridded(scan.cloud, scan.settings);
  if (!grid) {
    print_line({{"skipped", grid.error().message}});
    return {};
  }
  originals.grid = std::move(*grid);
  originals.points = count_returns(originals.grid);
  const PaperSettings limits = range_limits(scan.settings.paper, originals.grid);
  originals.raw = in_range(scan.cloud, limits);
  print_line({{"preset", scan.preset},
              {"returns", count_returns(scan.cloud)},
              {"returns_in_range", originals.raw.size()},
              {"grid_points", originals.points},
              {"min_range_m", limits.min_range_m},
              {"max_range_m", limits.max_range.metres}});

  const auto report = [&](const std::string& codec, const std::string& setting,
                          const Result<Outcome>& outcome) -> Status {
    if (outcome) return print_outcome(*outcome, originals);
    print_skipped(codec, setting, outcome.error().message);
    return {};
  };
  for (const Profile profile : {Profile::paper_global, Profile::paper, Profile::paper_1to1}) {
    CURLIDAR_TRY(report(to_string(profile), paper_setting(profile), paper_outcome(scan, profile)));
  }
  CURLIDAR_TRY(print_pcl(originals));
  for (const double error_m : kCompactErrors) {
    CURLIDAR_TRY(
        report("compact", error_setting(error_m), compact_outcome(originals.grid, error_m)));
  }
  return {};
}

}  // namespace curlidar::bench
