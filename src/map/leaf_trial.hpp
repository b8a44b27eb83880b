// SPDX-License-Identifier: BSD-3-Clause
// What a leaf would cost: J = distance of its samples + lambda bits. Encoder only.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "map/plane_fit.hpp"
#include "map/tile_state.hpp"
#include "map/tile_syntax.hpp"

namespace curlidar::tile {

/// Counts with the first model of every decision; nothing adapts.
class TileCost {
 public:
  static constexpr bool kDecodes = false;

  explicit TileCost(const TileModels& models) : models_(models) {}
  bool bit(const TileContexts& c, bool value) {
    cost_ += of(c, value);
    return value;
  }
  bool plain(bool value) {
    cost_ += 256;
    return value;
  }
  /// Of one bit, in 1/256 bit.
  std::uint32_t of(const TileContexts& c, bool value) const {
    const BitModel& model = models_.models[kTileModelRanges[c.decision].begin[0] + c.at[0]];
    const std::uint32_t p = model.probability;
    return bit_cost(p < 200 ? 200 : p > 65336 ? 65336 : p, value);
  }
  /// In bits.
  double bits() const { return static_cast<double>(cost_) / 256; }

 private:
  const TileModels& models_;
  std::uint64_t cost_ = 0;
};

/// What is weighed against what, in ticks.
struct TileWeighing {
  double lambda = 0;  ///< ticks a bit
  double drop = 0;    ///< a sample's distance where it is left out
  double near = 0;    ///< fits doubt what is farther away than this
  double bare =
      0;  ///< of surface without samples: what a square tick counts as, in ticks of distance
  double least = 0;  ///< J that samples must be worth to be looked at
};

/// A leaf and what it costs.
struct TriedLeaf {
  TileLeafCode code;
  double cost = std::numeric_limits<double>::infinity();  ///< J
};

/// The best leaf for the samples of a cube, given what is known before it.
TriedLeaf best_leaf(const TileState& state, const TileModels& models, const TileWeighing& weighing,
                    const CubeContext& c, const CubeSamples& cube);

}  // namespace curlidar::tile
