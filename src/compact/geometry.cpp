// SPDX-License-Identifier: BSD-3-Clause
#include "compact/geometry.hpp"

#include <utility>

namespace curlidar::compact {

Geometry::Geometry(std::vector<std::int32_t> elevations, std::uint32_t turn_columns,
                   std::uint32_t first_column, std::uint32_t columns)
    : elevations_(std::move(elevations)),
      turn_columns_(turn_columns),
      first_column_(first_column),
      columns_(columns) {
  std::vector<SinCos> azimuths(columns);
  for (std::uint32_t j = 0; j < columns; ++j) {
    azimuths[j] = sin_cos_q30(azimuth_of_column(first_column + j, turn_columns));
  }
  directions_.reserve(elevations_.size() * columns);
  const auto q22 = [](std::int64_t a, std::int64_t b) {
    return static_cast<std::int32_t>(shift_right_round(a * b, 38));
  };
  for (const std::int32_t elevation : elevations_) {
    const SinCos up = sin_cos_q30(static_cast<std::uint32_t>(elevation));
    const auto z = static_cast<std::int32_t>(shift_right_round(up.sin, 8));
    for (const SinCos& a : azimuths)
      directions_.push_back({q22(up.cos, a.cos), q22(up.cos, a.sin), z});
  }
}

std::uint32_t Geometry::azimuth_of_sum(std::uint32_t sum_of_columns) const {
  const std::uint64_t sum = std::uint64_t{2} * first_column_ + sum_of_columns;
  return static_cast<std::uint32_t>(0x80000000u + ((sum << 31) / turn_columns_));
}

}  // namespace curlidar::compact
