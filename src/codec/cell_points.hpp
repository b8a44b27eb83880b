// SPDX-License-Identifier: BSD-3-Clause
// Coordinates of the returns of an image's cells, the same doubles on every machine.
#pragma once

#include <cstdint>
#include <vector>

#include "compact/scan_points.hpp"
#include "records/directions.hpp"

namespace curlidar {

class CellPoints {
 public:
  CellPoints(const compact::RowTable& table, std::uint32_t rows, std::uint32_t columns)
      : table_(table), middles_(table, rows, columns) {}

  /// In the middle of a cell, or on its ray.
  Vec3 metres(std::uint32_t row, std::uint32_t column, std::int32_t range) const {
    return middles_.metres(row, column, range);
  }
  /// Beside the middle of a cell of a table without rays.
  Vec3 metres(std::uint32_t row, std::uint32_t column, std::int32_t range,
              const DirectionOffset& beside) const;

 private:
  const compact::RowTable& table_;
  compact::PointTable middles_;
};

/// The points of all occupied cells in raster order. `offsets`: of each of them, or empty.
std::vector<Vec3> cell_points(const compact::RowTable& table, const compact::Image& image,
                              const std::vector<DirectionOffset>& offsets);

}  // namespace curlidar
