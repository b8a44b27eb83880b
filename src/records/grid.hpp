// SPDX-License-Identifier: BSD-3-Clause
// What records are made of: cells of an image first, then points that are in no cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace curlidar {

/// The occupied cells, in raster order, are the first records; `loose` more follow.
struct CellGrid {
  std::uint32_t rows, columns;
  std::span<const std::uint8_t> occupied;  ///< row-major, rows x columns, not zero: holds a return
  std::size_t loose;
};

}  // namespace curlidar
