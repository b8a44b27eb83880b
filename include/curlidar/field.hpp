// SPDX-License-Identifier: BSD-3-Clause
// "Range in direction d": the continuous representation, whatever is beneath it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "curlidar/lattice.hpp"
#include "curlidar/vec3.hpp"

namespace curlidar {

/// A continuous range function on the viewing sphere with the lattice its returns were coded on.
/// Immutable; all members may be called from many threads.
class Field {
 public:
  virtual ~Field() = default;

  virtual const Lattice& lattice() const = 0;

  /// Ranges along one line of constant (fractional) lattice row, metres. Element i looks at
  /// fractional column `columns[i]` (any real number; wraps). ranges[i] is NaN where nothing is
  /// represented, or, with `masked`, where the masks say that no surface is to be believed.
  /// columns and ranges have the same size. Ascending columns are fastest.
  virtual void evaluate_row(double row, std::span<const double> columns, bool masked,
                            std::span<double> ranges) const = 0;

  /// The points of such a line in the frame of the coded cloud: element i lies ranges[i] along
  /// columns[i], and is NaN where the range is. All three have the same size.
  virtual void place_row(double row, std::span<const double> columns,
                         std::span<const double> ranges, std::span<Vec3> points) const;

  /// Whether the cell holds a coded return.
  virtual bool occupied(std::uint32_t row, std::uint32_t column) const = 0;

  /// The cell, row * columns + column, whose return is nearest to a direction; a cell without one
  /// if the direction is nobody's.
  virtual std::size_t nearest_cell(double row, double column) const;
};

}  // namespace curlidar
