// SPDX-License-Identifier: BSD-3-Clause
#include "compact/scan_points.hpp"

namespace curlidar::compact {

std::uint32_t elevation_at(const RowTable& table, std::uint32_t row, std::int32_t range) {
  constexpr std::int64_t kAnglePerRadian = 683565276;
  const auto base = static_cast<std::uint32_t>(table.elevation[row]);
  if (table.height.empty()) return base;
  return base + static_cast<std::uint32_t>(div_floor(table.height[row] * kAnglePerRadian, range));
}

FixedPoint point_at(std::int32_t range, const SinCos& elevation, const SinCos& azimuth) {
  const auto along = [&](std::int64_t part) {
    const std::int64_t direction = shift_right_round(part * elevation.cos, 30);
    return shift_right_round(range * direction, 10);
  };
  return {along(azimuth.cos), along(azimuth.sin),
          shift_right_round(std::int64_t{range} * elevation.sin, 10)};
}

Vec3 to_metres(const FixedPoint& point) {
  // At most 2^50 either way, so that both the conversion and the power of two are exact.
  constexpr double unit = 1.0 / (std::int64_t{1} << 36);
  return {static_cast<double>(point.x) * unit, static_cast<double>(point.y) * unit,
          static_cast<double>(point.z) * unit};
}

PointTable::PointTable(const RowTable& table, std::uint32_t rows, std::uint32_t columns)
    : table_(table) {
  if (table.rays) {
    rays_.emplace(table, rows);
    return;
  }
  if (table.height.empty()) {
    elevations_.reserve(rows);
    for (std::uint32_t row = 0; row < rows; ++row) {
      elevations_.push_back(sin_cos_q30(static_cast<std::uint32_t>(table.elevation[row])));
    }
  }
  azimuths_.reserve(columns);
  for (std::uint32_t column = 0; column < columns; ++column) {
    azimuths_.push_back(sin_cos_q30(
        azimuth_of_column(std::uint64_t{table.first_column} + column, table.turn_columns)));
  }
}

FixedPoint PointTable::fixed(std::uint32_t row, std::uint32_t column, std::int32_t range) const {
  if (rays_) return rays_->fixed(row, column, range);
  const SinCos elevation =
      elevations_.empty() ? sin_cos_q30(elevation_at(table_, row, range)) : elevations_[row];
  return point_at(range, elevation, azimuths_[column]);
}

}  // namespace curlidar::compact
