// SPDX-License-Identifier: BSD-3-Clause
// How much too far each ring measures, estimated from the scan itself.
#pragma once

#include <vector>

#include "codec/compact_grid.hpp"

namespace curlidar {

/// Range offset of each row, metres. Where three rows above each other see a smooth surface, the
/// middle one should lie on the plane through the other two, on which 1 / range is linear; the
/// median of what it lies off, of every row, makes a system of equations that a little damping
/// solves. HDL-64E: 2..10 cm; zeros where surfaces do not tell. Arithmetic and square roots of
/// doubles only, so that every machine finds the same. O(cells).
std::vector<double> estimate_range_offsets(const GriddedScan& scan, const RowModel& rows);

}  // namespace curlidar
