// SPDX-License-Identifier: BSD-3-Clause
// Coordinates of decoded cells, the same doubles on every machine.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "compact/fixed_point.hpp"
#include "compact/ray_points.hpp"
#include "compact/scan_types.hpp"
#include "curlidar/vec3.hpp"

namespace curlidar::compact {

/// The elevation at which row `row` sees a point at `range` (Q16 metres, > 0), a binary angle:
/// elevation + floor(height * 683565276 / range), 683565276 = round(2^32 / 2 pi).
std::uint32_t elevation_at(const RowTable& table, std::uint32_t row, std::int32_t range);

/// The point at `range` (1 .. 2^30, Q16 metres) of a direction given by its sines and cosines:
/// x = round(range * round(cos e cos a / 2^30) / 2^10), y with sin a, z = round(range * sin e /
/// 2^10); halves upwards. |coordinate| <= 2^50.
FixedPoint point_at(std::int32_t range, const SinCos& elevation, const SinCos& azimuth);

/// Exactly, in metres.
Vec3 to_metres(const FixedPoint& point);

/// The points of an image's cells, along rays where the table has some; otherwise azimuths and,
/// where no row has a height, elevations are looked up. The table outlives this.
class PointTable {
 public:
  PointTable(const RowTable& table, std::uint32_t rows, std::uint32_t columns);

  FixedPoint fixed(std::uint32_t row, std::uint32_t column, std::int32_t range) const;
  Vec3 metres(std::uint32_t row, std::uint32_t column, std::int32_t range) const {
    return to_metres(fixed(row, column, range));
  }

 private:
  const RowTable& table_;
  std::optional<RayPoints> rays_;
  std::vector<SinCos> elevations_, azimuths_;
};

}  // namespace curlidar::compact
