// SPDX-License-Identifier: BSD-3-Clause
#include "paper/masks.hpp"

#include <cmath>

namespace curlidar {
namespace {

constexpr double kOnCell = 1e-9;

void split(double value, std::int64_t& whole, double& fraction) {
  const double nearest = std::round(value);
  const double base = std::abs(value - nearest) <= kOnCell ? nearest : std::floor(value);
  whole = static_cast<std::int64_t>(base);
  fraction = base == nearest && std::abs(value - nearest) <= kOnCell ? 0 : value - base;
}

}  // namespace

CellMasks::CellMasks(std::uint32_t rows_, std::uint32_t columns_) : rows(rows_), columns(columns_) {
  const std::size_t cells = static_cast<std::size_t>(rows) * columns;
  for (auto* mask : {&point, &cliff_row, &cliff_column, &cliff_diagonal}) mask->assign(cells, 0);
}

CellPosition CellPosition::of(double row, double column) {
  CellPosition p;
  split(row, p.row, p.row_fraction);
  split(column, p.column, p.column_fraction);
  return p;
}

CellMasks make_masks(const RangeImage& image, const CliffThresholds& thresholds) {
  CellMasks masks(image.lattice.rows(), image.lattice.columns());
  std::vector<Vec3> points(image.source.size());
  for (std::size_t row = 0; row < masks.rows; ++row) {
    for (std::size_t column = 0; column < masks.columns; ++column) {
      const std::size_t cell = image.index(row, column);
      masks.point[cell] = image.occupied(cell);
      if (masks.point[cell]) points[cell] = image.point(row, column);
    }
  }
  const auto is_cliff = [&](std::size_t a, std::size_t b, double threshold) -> std::uint8_t {
    if (masks.point[a] != masks.point[b]) return 1;
    return masks.point[a] != 0 && norm(points[a] - points[b]) > threshold;
  };
  for (std::int64_t row = 0; row < masks.rows; ++row) {
    for (std::int64_t column = 0; column < masks.columns; ++column) {
      const std::size_t cell = masks.index(row, column);
      masks.cliff_column[cell] = is_cliff(cell, masks.index(row, column - 1), thresholds.column_m);
      if (row == 0) continue;
      masks.cliff_row[cell] = is_cliff(cell, masks.index(row - 1, column), thresholds.row_m);
      masks.cliff_diagonal[cell] =
          is_cliff(cell, masks.index(row - 1, column - 1), thresholds.diagonal_m);
    }
  }
  return masks;
}

bool believed(const CellMasks& masks, const CellPosition& p) {
  const bool between_rows = p.row_fraction > 0, between_columns = p.column_fraction > 0;
  if (p.row < 0 || p.row + (between_rows ? 1 : 0) >= masks.rows) return false;
  const std::int64_t near_row = p.row + (p.row_fraction >= 0.5 ? 1 : 0);
  const std::int64_t near_column = p.column + (p.column_fraction >= 0.5 ? 1 : 0);
  if (!masks.point[masks.index(near_row, near_column)]) return false;
  if (between_rows && masks.cliff_row[masks.index(p.row + 1, near_column)]) return false;
  if (between_columns && masks.cliff_column[masks.index(near_row, p.column + 1)]) return false;
  return !(between_rows && between_columns &&
           masks.cliff_diagonal[masks.index(p.row + 1, p.column + 1)]);
}

void refuse(CellMasks& masks, const CellPosition& p) {
  const bool between_rows = p.row_fraction > 0, between_columns = p.column_fraction > 0;
  if (between_rows && between_columns) {
    masks.cliff_diagonal[masks.index(p.row + 1, p.column + 1)] = 1;
  } else if (between_rows) {
    masks.cliff_row[masks.index(p.row + 1, p.column)] = 1;
  } else if (between_columns) {
    masks.cliff_column[masks.index(p.row, p.column + 1)] = 1;
  } else {
    masks.point[masks.index(p.row, p.column)] = 0;
  }
}

}  // namespace curlidar
