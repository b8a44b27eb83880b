// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-B2: which directions hold a surface. Four bitmaps on the original lattice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/settings.hpp"
#include "image/range_image.hpp"

namespace curlidar {

/// 0 or 1 a cell. A cliff is a broken surface between a cell and its neighbour in the previous
/// row (same column), the previous column (same row), or both (diagonal); columns wrap, rows do
/// not. A neighbour without a return breaks the surface as well.
struct CellMasks {
  std::uint32_t rows = 0, columns = 0;
  std::vector<std::uint8_t> point, cliff_row, cliff_column, cliff_diagonal;

  CellMasks() = default;
  CellMasks(std::uint32_t rows_, std::uint32_t columns_);

  std::size_t index(std::int64_t row, std::int64_t column) const {
    const auto width = static_cast<std::int64_t>(columns);
    return static_cast<std::size_t>(row * width + ((column % width) + width) % width);
  }
};

/// Fractional rows and columns beyond this are nowhere.
inline constexpr double kMaxIndex = 1e9;
/// Whether a fractional index is a number that CellPosition can split.
inline bool is_index(double index) {
  return index >= -kMaxIndex && index <= kMaxIndex;
}

/// Where a direction lies among the cells of a lattice: between rows `row` and row + 1 at
/// row_fraction in [0, 1), likewise for columns. A fraction of exactly 0 is on the cell.
struct CellPosition {
  std::int64_t row = 0, column = 0;
  double row_fraction = 0, column_fraction = 0;

  /// Splits fractional indices of magnitude up to kMaxIndex; positions within 1e-9 of a cell are
  /// on it.
  static CellPosition of(double row, double column);
};

/// Masks of a depth image.
CellMasks make_masks(const RangeImage& image, const CliffThresholds& thresholds);

/// Whether a surface is to be believed there: the nearest cell holds a return, and no cliff lies
/// between the cells around. Nothing is believed above the first row or below the last.
bool believed(const CellMasks& masks, const CellPosition& position);

/// Sets the cliff that a sample at the position would have to cross, or clears the cell itself.
void refuse(CellMasks& masks, const CellPosition& position);

}  // namespace curlidar
