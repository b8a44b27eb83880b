// SPDX-License-Identifier: BSD-3-Clause
// A gridded scan in the compact profile's integers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/compact_grid.hpp"
#include "compact/scan_types.hpp"
#include "records/directions.hpp"

namespace curlidar {

/// The largest range that can be coded; farther returns are dropped as out of range.
inline constexpr double kMaxCompactRangeM = 2047;

/// What is coded: ranges and rows, and where returns lie beside the middles of their cells.
struct CompactModel {
  compact::Image image;
  compact::RowTable table;
  std::int32_t direction_step = 0;       ///< Q16 metres; 0: offsets are not coded
  std::vector<DirectionOffset> offsets;  ///< of the occupied cells in raster order, if they are
};

/// Rounds ranges to 1/65536 m, and rows so that what they add to an error of `error_m` is lost
/// in it.
CompactModel make_model(const GriddedScan& scan, const RowModel& rows, double error_m);

/// Gives a table range offsets (metres), rounded so that `error_m` does not show it; none if all
/// come out as 0.
void set_range_offsets(compact::RowTable& table, const std::vector<double>& offsets,
                       double error_m);

/// Distances, metres.
struct OwnErrors {
  double mean = 0, rms = 0, max = 0;
};
/// Distances from decoded points, those of the occupied cells in raster order, to their originals.
OwnErrors own_errors(const Cloud& cloud, const GriddedScan& scan, const std::vector<Vec3>& points);

/// Where originals lie beside their cells' middles, mean, metres: across is what more columns make
/// smaller.
struct CellOffsets {
  double across = 0, along = 0;
};
CellOffsets cell_offsets(const Cloud& cloud, const GriddedScan& scan,
                         const compact::RowTable& table);

/// The points of the occupied cells in raster order, as a decoder gives them that finds the ranges
/// of `decoded` and the offsets rounded to the direction step.
std::vector<Vec3> points_of(const CompactModel& model, const compact::Image& decoded);

}  // namespace curlidar
