// SPDX-License-Identifier: BSD-3-Clause
// A scan on its lattice of true rings and even columns, as the compact profile codes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "curlidar/codec.hpp"

namespace curlidar {

/// rows x columns cells, row-major, top row first.
struct GriddedScan {
  std::uint32_t rows = 0, columns = 0;
  std::vector<double> range;                ///< metres; 0 in empty cells
  std::vector<std::uint32_t> source;        ///< point that fills the cell; kNoPoint in empty ones
  std::vector<double> elevations;           ///< of the rows as the returns show them, descending
  bool cell_centres = false;                ///< the cloud brought this very grid
  std::string sensor;                       ///< name of its profile; "grid" for cell centres
  double min_range_m = 0, max_range_m = 0;  ///< returns beyond them are left out
  ProjectionCounts counts;

  std::size_t cell(std::uint32_t row, std::uint32_t column) const {
    return static_cast<std::size_t>(row) * columns + column;
  }
};

/// Lays a cloud on its lattice. An organised cloud whose points are cell centres (what `project`
/// makes) goes back to exactly its cells. Otherwise rows are the rings that detect_sensor or the
/// given sensor's profile tells, columns the settings' or an organised cloud's own, and the return
/// nearest a cell's middle keeps it. Errors: no return, a limited-field scanner, nothing left.
Result<GriddedScan> grid_scan(const Cloud& cloud, const EncodeSettings& settings);

/// The lattice of a cloud whose points are cell centres; nothing if it has none.
std::optional<GriddedScan> cell_centre_scan(const Cloud& cloud, double min_range_m,
                                            double max_range_m);

/// The returns of rings that are known on even columns, those within max_range_m; of several in a
/// cell the one nearest its middle.
GriddedScan ring_scan(const Cloud& cloud, const Detection& detection, std::uint32_t columns,
                      double min_range_m, double max_range_m);

/// How rows look at their returns: at elevation + height / range.
struct RowModel {
  std::vector<double> elevation;  ///< radians, strictly descending
  std::vector<double> height;     ///< metres; empty = all 0
};
/// Least squares of the heights at which the beams of each ring leave the axis. Heights come out
/// empty unless they bring the returns' mean vertical distance from their rows down so far that an
/// error of `error_m` beside it shrinks by more than they cost. O(cells).
RowModel fit_rows(const Cloud& cloud, const GriddedScan& scan, double error_m);

}  // namespace curlidar
