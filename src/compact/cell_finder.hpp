// SPDX-License-Identifier: BSD-3-Clause
// Which cell of a scan sees a place in space. Integers that decoder and encoder must agree on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "compact/scan_types.hpp"

namespace curlidar::compact {

/// A place as seen from a field's centre, Q16 metres.
struct Place {
  std::int64_t x = 0, y = 0, z = 0;
};

/// The binary angle of (x, y), |x|, |y| < 2^31: within 2^-20 of a turn of the true one.
std::uint32_t azimuth_of(std::int64_t x, std::int64_t y);

class CellFinder {
 public:
  static constexpr std::int64_t kNowhere = -1;

  CellFinder(const RowTable& table, std::uint32_t rows, std::uint32_t columns);

  /// row * columns + column, or kNowhere.
  std::int64_t cell_of(const Place& place) const;
  /// The column of a row that looks along an encoder angle, or kNowhere.
  std::int64_t column_at(std::uint32_t row, std::uint32_t encoder_angle) const;

 private:
  struct Row {
    std::int64_t slope = 0;  ///< tangent of the elevation, Q16
    std::int64_t height = 0, lateral = 0;
    std::uint32_t azimuth_offset = 0;
    std::int64_t shift = 0;
    std::uint32_t row = 0;
  };
  std::int64_t height_at(const Row& row, std::int64_t level) const {
    return ((level * row.slope) >> 16) + row.height;
  }

  std::vector<Row> sorted_;               ///< the highest first
  std::vector<std::int64_t> shifts_;      ///< of each row
  std::vector<std::uint32_t> positions_;  ///< of firings, binary angles; empty: even columns
  std::uint32_t columns_, turn_columns_, first_column_;
};

/// Where a cell's line of sight starts and where it points to, for any table: heights of rows
/// count as origins.
class Sights {
 public:
  Sights(const RowTable& table, std::uint32_t rows, std::uint32_t columns);

  Sight at(std::size_t cell) const {
    Sight sight = geometry_.sight(cell);
    if (!heights_.empty()) sight.origin.z += heights_[cell / geometry_.columns()];
    return sight;
  }

 private:
  Geometry geometry_;
  std::vector<std::int32_t> heights_;
};

}  // namespace curlidar::compact
