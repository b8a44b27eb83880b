// SPDX-License-Identifier: BSD-3-Clause
// Records: the returns of a cloud as they are coded, in cells of a scan or without one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace curlidar {

/// Which cells of a rows x columns scan hold a record, and how many records have no cell. Records
/// are numbered: first those of the occupied cells in raster order (row by row), then the loose
/// ones. No scan at all: no rows.
struct CellGrid {
  std::uint32_t rows = 0, columns = 0;
  std::span<const std::uint8_t> occupied;  ///< of each cell in raster order: not 0 if it is
  std::size_t loose = 0;

  std::size_t cells() const { return occupied.size(); }
  /// Number of records. O(cells).
  std::size_t records() const {
    return cells() - static_cast<std::size_t>(std::count(occupied.begin(), occupied.end(), 0)) +
           loose;
  }
};

/// What attributes are predicted from besides each other: the coded geometry.
struct RecordGeometry {
  CellGrid grid;
  /// Range of each cell in Q16 metres as decoded; ignored where no record is. Empty: not known.
  std::span<const std::int32_t> range_q16;
  /// For each row, how many columns its cells lie ahead of those that fired together with them
  /// (RayTable::column_shift). Empty: none.
  std::span<const std::int32_t> column_shift;
};

}  // namespace curlidar
