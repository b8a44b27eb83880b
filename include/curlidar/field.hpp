// SPDX-License-Identifier: BSD-3-Clause
// "Range in direction d": the continuous representation, whatever is beneath it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curlidar/lattice.hpp"

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

  /// Elevation at which a point at `range` metres of a fractional row is seen: that of the row,
  /// unless its beams start away from the origin.
  virtual double elevation(double row, [[maybe_unused]] double range) const {
    return lattice().elevation(row);
  }
  /// Whether elevation() does not depend on the range.
  virtual bool one_elevation_a_row() const { return true; }

  /// Whether the cell holds a coded return.
  virtual bool occupied(std::uint32_t row, std::uint32_t column) const = 0;
};

}  // namespace curlidar
