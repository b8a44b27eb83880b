// SPDX-License-Identifier: BSD-3-Clause
// Which cells of a row of rays lie beside a direction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compact/scan_types.hpp"

namespace curlidar {

/// Two cells of a row to either side of a direction; the weights add up to 1, or less where no ray
/// looked.
struct ColumnPair {
  std::uint32_t left = 0, right = 0;
  double left_weight = 0, right_weight = 0;
};

/// Rays start beside the spin axis. A direction seen from the axis is therefore looked for among
/// the azimuths at which the axis sees the cells' points, not among those of the rays: 2.6 cm at
/// 5 m are almost two columns of an HDL-64E, and to the other side in every other row. Where points
/// follow each other backwards, behind the edge of something near, they count as seen at the edge.
class RayColumns {
 public:
  /// `table` has rays and is valid (check_rays). `range`: Q16 metres of each cell, row-major, for
  /// empty ones of something near them, or 0. O(cells).
  RayColumns(const compact::RowTable& table, std::span<const std::int32_t> range);

  /// The cells beside an azimuth (binary angle): weighted by nearness, and a cell at which it is
  /// aimed has all of the weight. Over firings that are missing a cell reaches no farther than one
  /// usual column. O(log columns).
  ColumnPair around(std::uint32_t row, std::uint32_t azimuth) const;

 private:
  const std::uint32_t* seen_in(std::uint32_t row) const {
    return seen_.data() + std::size_t{row} * columns_;
  }

  std::uint32_t columns_;
  std::uint32_t usual_step_ = 0;      ///< between firings, a binary angle
  std::vector<std::uint8_t> wide_;    ///< of each firing: whether some are missing behind it
  std::vector<std::int32_t> shift_;   ///< column_shift of each row
  std::vector<std::uint32_t> first_;  ///< azimuth of the point of each row's column 0
  std::vector<std::uint32_t> seen_;   ///< of each cell's point from there on, ascending
};

}  // namespace curlidar
