// SPDX-License-Identifier: BSD-3-Clause
// The directions of a lattice's cells in integers: what decoder and encoder must agree on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "compact/ray_table.hpp"
#include "fixed/fixed.hpp"

namespace curlidar::compact {

/// One unit of range is 1 / kRangeUnit metres (Q16).
inline constexpr std::int32_t kRangeUnit = 1 << 16;
/// Ranges of the field: 1/16 m .. 2048 m.
inline constexpr std::int64_t kMinRange = 1 << 12;
inline constexpr std::int64_t kMaxRange = std::int64_t{1} << 27;

/// A direction in Q22.
struct Direction {
  std::int32_t x = 0, y = 0, z = 0;
};

/// A place beside the field's centre, Q16 metres.
struct Origin {
  std::int32_t x = 0, y = 0, z = 0;
};

/// A line of sight.
struct Sight {
  Direction direction;
  Origin origin;
};

/// A vector in Q30.
struct Axis {
  std::int64_t x = 0, y = 0, z = 0;
};

/// Rows at given elevations, columns evenly around the full turn or along a sensor's own rays, as
/// one segment of a scan sees them: row 0 and column 0 are the segment's own.
class Geometry {
 public:
  /// `elevations`: binary angles of the segment's rows, top to bottom. Its columns are
  /// first_column .. first_column + columns - 1 of turn_columns.
  Geometry(std::vector<std::int32_t> elevations, std::uint32_t turn_columns,
           std::uint32_t first_column, std::uint32_t columns);
  /// The cells first_row .., first_column .. of a table of rays.
  Geometry(std::vector<std::int32_t> elevations, const RayTable& rays, std::uint32_t first_row,
           std::uint32_t first_column, std::uint32_t columns);

  std::uint32_t rows() const { return static_cast<std::uint32_t>(elevations_.size()); }
  std::uint32_t columns() const { return columns_; }
  std::uint32_t turn_columns() const { return turn_columns_; }
  std::size_t cells() const { return directions_.size(); }
  const std::vector<std::int32_t>& elevations() const { return elevations_; }

  /// Of the middle of cell (row, column): directions()[row * columns() + column].
  const std::vector<Direction>& directions() const { return directions_; }
  /// How a cell looks: from the field's centre where no row has an origin of its own.
  Sight sight(std::size_t cell) const {
    return {directions_[cell], origins_.empty() ? Origin{} : origins_[cell]};
  }

  /// The azimuth half-way between the middles of two columns given by their sum, a binary angle.
  std::uint32_t azimuth_of_sum(std::uint32_t sum_of_columns) const;

 private:
  std::vector<std::int32_t> elevations_;
  std::uint32_t turn_columns_, first_column_, columns_;
  std::vector<Direction> directions_;
  std::vector<Origin> origins_;                 ///< of each cell; empty = all at the centre
  std::vector<std::uint32_t> column_azimuths_;  ///< encoder angles of a table's firings
};

/// Height of the field's centre above the sensor's origin, Q16 metres: the mean of the rays'
/// heights, rounded down.
std::int32_t centre_height(const RayTable& rays);

/// The azimuth of a column of the turn: -pi + 2 pi column / columns, rounded down.
inline std::uint32_t azimuth_of_column(std::uint64_t column, std::uint32_t turn_columns) {
  return static_cast<std::uint32_t>(0x80000000u + ((column << 32) / turn_columns));
}

}  // namespace curlidar::compact
