// SPDX-License-Identifier: BSD-3-Clause
// The depth image of the paper (Eq. 2): one range per cell of a lattice, with its source point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "curlidar/lattice.hpp"
#include "curlidar/project.hpp"

namespace curlidar {

inline constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();

/// rows x columns cells, row-major; a cell is occupied where `source` is not kNoPoint.
struct RangeImage {
  Lattice lattice;
  std::vector<double> range;          ///< metres; 0 in empty cells
  std::vector<std::uint32_t> source;  ///< index of the point that filled the cell

  std::size_t index(std::size_t row, std::size_t column) const {
    return row * lattice.columns() + column;
  }
  bool occupied(std::size_t cell) const { return source[cell] != kNoPoint; }
  /// Point at the centre direction of a cell.
  Vec3 point(std::size_t row, std::size_t column) const {
    return lattice.direction(static_cast<double>(row), static_cast<double>(column)) *
           range[index(row, column)];
  }
};

/// The limit in metres: the given number, the percentile over all returns of `cloud`, or the
/// sensor's own limit.
double resolve_max_range(const RangeLimit& limit, const Cloud& cloud, const SensorProfile& sensor);

/// The lattice that the settings ask for.
Lattice make_lattice(const ProjectSettings& settings, const SensorProfile& sensor);

/// Drops every return with range outside [min_range, max_range], with `keep[i]` false (keep may
/// be empty), or beyond half a row from the outermost rows; of the returns in one cell the one
/// nearest the cell's centre direction wins (then the nearer one, then the first). O(n).
RangeImage fill_range_image(const Cloud& cloud, const std::vector<std::uint16_t>& ring_of_point,
                            const Lattice& lattice, RowRule row_rule, double min_range_m,
                            double max_range_m, const std::vector<bool>& keep,
                            ProjectionCounts& counts);

}  // namespace curlidar
