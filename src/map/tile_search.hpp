// SPDX-License-Identifier: BSD-3-Clause
// The octree below a root that costs least. Encoder only.
#pragma once

#include <cstdint>
#include <vector>

#include "map/leaf_trial.hpp"
#include "map/tile_tree.hpp"

namespace curlidar::tile {

/// Searches cubes in the order in which they are coded, each given what was chosen before it;
/// leaves the state as if what it found had been coded.
class TileSearch {
 public:
  TileSearch(TileState& state, const TileModels& models, const TileWeighing& weighing,
             const TileSamples& samples)
      : state_(state), models_(models), weighing_(weighing), samples_(samples) {}

  /// The best tree for a root's samples; -1 where it is better left out. `c` as the state has it.
  std::int32_t root(const CubeContext& c, const RootSamples& root);
  const std::vector<TileNode>& nodes() const { return nodes_; }

 private:
  struct Found {
    std::int32_t node = -1;
    double cost = 0;
  };
  Found search(const CubeContext& c, std::size_t begin, std::size_t end);
  Found split(const CubeContext& c, std::size_t begin, std::size_t end, double bound);
  /// Of samples that are left out.
  double cost_left(std::size_t begin, std::size_t end) const;
  double occupied_cost(const CubeContext& c, std::uint32_t siblings, bool occupied) const;
  double split_cost(const CubeContext& c, bool split) const;

  TileState& state_;
  const TileModels& models_;
  const TileWeighing& weighing_;
  const TileSamples& samples_;
  std::vector<TileNode> nodes_;
};

}  // namespace curlidar::tile
