// SPDX-License-Identifier: BSD-3-Clause
// Real scans as the compact profile's integers, where the data is present.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "curlidar/io.hpp"
#include "curlidar/project.hpp"
#include "support/compact_scans.hpp"
#include "support/data.hpp"

namespace curlidar::test {

/// The scan on its real rings, 1024 columns, from 5 m to the ninetieth percentile of range. Ranges
/// are those of the returns, elevations those of the rings in this scan.
inline std::optional<CompactScan> project_real_scan(const std::string& path) {
  const auto cloud = read_cloud(path);
  if (!cloud) return std::nullopt;
  const auto detection = detect_sensor(*cloud);
  if (!detection) return std::nullopt;
  ProjectSettings settings;
  settings.row_rule = RowRule::rings;
  settings.min_range_m = 5;
  settings.max_range.percentile = 90;
  const auto grid = project(*cloud, *detection, settings);
  if (!grid) return std::nullopt;
  CompactScan scan;
  scan.image.rows = grid->height;
  scan.image.columns = scan.table.turn_columns = grid->width;
  scan.table.elevation_shift = 16;
  for (const double e : detection->ring_elevations) {
    scan.table.elevation.push_back(
        static_cast<std::int32_t>(std::lround(e / std::numbers::pi * 2147483648.0)));
  }
  round_to_shifts(scan.table);
  for (const Vec3& p : grid->positions) {
    const double range = is_return(p) ? norm(p) : 0;
    scan.image.range.push_back(static_cast<std::int32_t>(std::lround(range * 65536)));
  }
  return scan;
}

}  // namespace curlidar::test
