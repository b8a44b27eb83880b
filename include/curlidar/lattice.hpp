// SPDX-License-Identifier: BSD-3-Clause
// The grid of directions on which the returns of a scan are coded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/vec3.hpp"

namespace curlidar {

/// Rows (top first) x columns (azimuth -pi first, counter-clockwise). A cell looks at
/// (elevation(row), azimuth(column)); both are defined for fractional indices, columns wrap.
class Lattice {
 public:
  /// `rows` elevations evenly spaced from fov_up (row 0) to fov_down (last row), both included:
  /// the paper's grid.
  static Lattice uniform(std::uint32_t rows, std::uint32_t columns, double fov_up, double fov_down);
  /// One row per elevation, strictly descending (radians), at least one.
  static Lattice from_rings(std::vector<double> elevations, std::uint32_t columns);

  std::uint32_t rows() const { return static_cast<std::uint32_t>(elevations_.size()); }
  std::uint32_t columns() const { return columns_; }
  std::size_t cells() const { return static_cast<std::size_t>(rows()) * columns_; }
  bool is_uniform() const { return uniform_; }
  const std::vector<double>& elevations() const { return elevations_; }

  /// Elevation of a fractional row: linear between rows, extrapolated with the outermost step.
  double elevation(double row) const;
  /// Azimuth of a fractional column: -pi + 2 pi column / columns.
  double azimuth(double column) const;
  Vec3 direction(double row, double column) const {
    return direction_of(elevation(row), azimuth(column));
  }

  /// Fractional row of an elevation (inverse of elevation()).
  double row_of(double elevation) const;
  /// Fractional column of an azimuth, in [0, columns).
  double column_of(double azimuth) const;
  /// The same column in [0, columns); 0 for what is no number or too large to tell.
  double within_turn(double column) const;

 private:
  std::vector<double> elevations_;
  std::uint32_t columns_ = 0;
  bool uniform_ = false;
};

/// The directions of a lattice made row_factor x column_factor denser: row i of the dense grid
/// looks along fractional row `row(i)` of the lattice, column j along `column(j)`. The last row
/// stays the lattice's last row, as in the paper, so that factor 2 adds a half row above the top.
struct DenseGrid {
  DenseGrid(const Lattice& lattice, double row_factor, double column_factor);

  double row(std::size_t i) const {
    return last_row - static_cast<double>(rows - 1 - i) / row_factor;
  }
  double column(std::size_t j) const { return static_cast<double>(j) * column_step; }

  std::uint64_t rows = 0, columns = 0;  ///< at least 1; rounded from factor * lattice size
  double row_factor = 1;
  double column_step = 1;  ///< in lattice columns; lattice columns / columns
  double last_row = 0;
};

}  // namespace curlidar
