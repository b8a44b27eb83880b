// SPDX-License-Identifier: BSD-3-Clause
// A walk over all cells of a grid in about the order in which a file lists them.
#pragma once

#include <cstdint>
#include <vector>

#include "entropy/range_coder.hpp"

namespace curlidar {

/// Row by row: rows in the order `rows`, each from its own first column once round. Or column by
/// column: step t visits in every row, in the order `rows`, the t-th cell from its first column.
struct Walk {
  bool by_column = false;
  bool backward = false;             ///< towards smaller columns
  std::vector<std::uint32_t> rows;   ///< every row once
  std::vector<std::uint32_t> first;  ///< column, of each row

  /// Row by row, all forward from column 0.
  static Walk raster(std::uint32_t rows);
  /// All cells (row * columns + column) as visited. Takes a walk of that many rows whose columns
  /// are below `columns`.
  std::vector<std::uint32_t> cells(std::uint32_t columns) const;

  friend bool operator==(const Walk&, const Walk&) = default;
};

void write_walk(RangeEncoder& coder, const Walk& walk, std::uint32_t columns);
/// A walk over a grid of this size. False if the bytes tell none.
bool read_walk(RangeDecoder& coder, Walk& walk, std::uint32_t rows, std::uint32_t columns);

}  // namespace curlidar
