// SPDX-License-Identifier: BSD-3-Clause
// Jumps of a range function between neighbouring cells of its lattice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curlidar/field.hpp"

namespace curlidar::bench {

/// Two cells beside each other that both hold a return and look almost the same way.
struct CellPair {
  std::uint32_t row = 0, column = 0;
  bool down = false;    ///< the other one is in the next row, else in the next column
  bool border = false;  ///< they belong to different blocks
};

/// Pairs of the lattice, `most` of each kind (on a border, within a block) at most, evenly taken.
/// `block[row * columns + column]` tells the block of a cell.
std::vector<CellPair> cell_pairs(const Field& field, std::span<const std::uint32_t> block,
                                 std::size_t most);

inline constexpr std::size_t kStops = 17;  ///< from one cell's middle to the other's
/// Points told on the way from one cell of a pair to the other; NaN where no surface is believed.
std::array<Vec3, kStops> way_between(const Field& field, const CellPair& pair);

/// The jump on a way, metres: what its largest step is more than the other steps. Inverse ranges,
/// so that planes have none however they are seen. NaN if a range on the way is.
double jump_of(const std::array<double, kStops>& ranges_m);

}  // namespace curlidar::bench
