// SPDX-License-Identifier: BSD-3-Clause
// The samples of a tile as its search takes them: in ticks, sorted by root and by place within it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/map_settings.hpp"
#include "curlidar/result.hpp"
#include "map/tile_geometry.hpp"

namespace curlidar::tile {

struct TileSamples {
  std::array<std::vector<double>, 3> at;  ///< coordinates in ticks, whole numbers
  std::vector<double> weight;
  std::vector<float> intensity;     ///< NaN: unknown
  std::vector<double> drop;         ///< distance that counts where nothing new is near, ticks
  std::vector<double> left;         ///< weight times that: what leaving out costs
  std::vector<std::uint32_t> fine;  ///< place within the root, in Morton order of the finest cubes

  std::size_t size() const { return weight.size(); }
};

/// Samples [begin, end) of one root.
struct RootSamples {
  TileCube cube;
  std::size_t begin = 0, end = 0;
};

struct SortedSamples {
  TileSamples samples;
  std::vector<RootSamples> roots;  ///< in the order of the roots
};

/// Sorts; widens the layout's rows. invalid_argument: a sample outside of the tile or without
/// weight; limit_exceeded: more rows of roots than a tile may have.
Result<SortedSamples> sort_samples(const std::vector<MapSample>& samples, TileLayout& layout);

/// Scales the weights of every finest cube whose samples weigh more than `most`.
void limit_weights(SortedSamples& sorted, double most);

/// Sets `left` of weights and drops.
void weigh_left(TileSamples& samples);

/// Most roots that a tile may have.
inline constexpr std::uint32_t kMaxRoots = 1 << 16;
inline constexpr std::int32_t kMaxRow = 1 << 15;

}  // namespace curlidar::tile
