// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/inputs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "curlidar/paper.hpp"

namespace curlidar::bench {

Result<Scan> read_scan(const Arguments& arguments) {
  Scan scan;
  scan.path = arguments.words.front();
  CURLIDAR_TRY_ASSIGN(cloud, read_cloud(scan.path));
  scan.cloud = std::move(cloud);
  scan.preset = arguments.option("preset", suggest_preset(scan.cloud));
  CURLIDAR_TRY_ASSIGN(paper, paper_preset(scan.preset));
  scan.settings.profile = Profile::paper;
  scan.settings.paper = paper;
  scan.settings.attributes.emplace();
  scan.settings.threads = 1;
  const std::string sensor = arguments.option("sensor", "auto");
  if (sensor != "auto") {
    CURLIDAR_TRY_ASSIGN(profile, load_sensor(sensor));
    scan.settings.sensor = std::move(profile);
  }
  return scan;
}

Result<std::shared_ptr<const DensityProfile>> density_profile_of(const Arguments& arguments,
                                                                 const std::string& option) {
  const std::string name = arguments.option(option, "");
  if (name.empty()) return std::shared_ptr<const DensityProfile>();
  return load_density_profile(name);
}

EncodeSettings of_profile(EncodeSettings settings, Profile profile) {
  settings.profile = profile;
  settings.paper = for_profile(settings.paper, profile);
  return settings;
}

Result<Cloud> gridded(const Cloud& scan, EncodeSettings settings) {
  settings.paper.upsample_rows = settings.paper.upsample_columns = 1;
  CURLIDAR_TRY_ASSIGN(grid, upsample_scan(scan, settings));
  return std::move(grid.cloud);
}

PaperSettings range_limits(PaperSettings settings, const Cloud& grid) {
  settings.max_range = {};
  for (const Vec3& p : grid.positions) {
    if (is_return(p)) settings.max_range.metres = std::max(settings.max_range.metres, norm(p));
  }
  return settings;
}

EncodeSettings for_fewer_rings(EncodeSettings settings, const SensorProfile& sensor, double times) {
  settings.sensor = sensor;
  settings.paper.row_rule = RowRule::rings;
  settings.paper.columns = std::min(settings.paper.columns, sensor.columns);
  CliffThresholds& cliffs = settings.paper.cliffs;
  cliffs.row_m *= times;
  cliffs.diagonal_m = std::hypot(cliffs.row_m, cliffs.column_m);
  return settings;
}

Result<RangeLimits> limits_of(const Cloud& cloud, const EncodeSettings& settings) {
  CURLIDAR_TRY_ASSIGN(grid, gridded(cloud, settings));
  const PaperSettings limits = range_limits(settings.paper, grid);
  return RangeLimits{limits.min_range_m, limits.max_range.metres};
}

Cloud in_range(const Cloud& scan, const PaperSettings& settings) {
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < scan.size(); ++i) {
    const double range = is_return(scan.positions[i]) ? norm(scan.positions[i]) : 0;
    if (range >= settings.min_range_m && range <= settings.max_range.metres) kept.push_back(i);
  }
  return select(scan, kept);
}

}  // namespace curlidar::bench
