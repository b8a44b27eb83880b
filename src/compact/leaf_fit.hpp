// SPDX-License-Identifier: BSD-3-Clause
// Fits one layer of a leaf to returns. Encoder only: doubles, but only +, -, *, / and sqrt in a
// fixed order, which every compiler rounds alike; every decision is taken on the integer ranges
// that the decoder will see.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "compact/field_syntax.hpp"

namespace curlidar::compact {

/// The returns of a block with what every fit needs of them.
struct LeafSamples {
  std::vector<std::uint32_t> cells;
  std::vector<Direction> directions;
  std::vector<std::int64_t> ranges;                      ///< Q16
  std::vector<double> weights;                           ///< r^4 in metres
  std::vector<std::array<double, kMaxFunctions>> basis;  ///< B0..B5

  LeafSamples(const FieldState& state, const PatchFrame& frame,
              const std::vector<std::int32_t>& truth, const Block& block);
  std::size_t size() const { return cells.size(); }
};

/// The layer with `functions` (place in kFunctions) that fits the `members` of the samples best
/// in the square of range, each weighted by `extra` (empty = all 1), its coefficients rounded one
/// after the other to the lattice of steps (Babai's nearest plane). `parent` = 0: a new surface at
/// the members' median range. nullopt where no such layer exists.
std::optional<LayerCode> fit_layer(const FieldState& state, const BlockContext& context,
                                   const PatchFrame& frame, const LeafSamples& samples,
                                   const std::vector<std::uint32_t>& members,
                                   const std::vector<double>& extra, std::uint32_t parent,
                                   std::uint32_t functions);

}  // namespace curlidar::compact
