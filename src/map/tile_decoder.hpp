// SPDX-License-Identifier: BSD-3-Clause
// A tile's bytes as leaves, and as the trees that they were coded as.
#pragma once

#include <cstddef>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/map_settings.hpp"
#include "curlidar/map_tile.hpp"
#include "curlidar/result.hpp"
#include "map/tile_tree.hpp"

namespace curlidar::tile {

struct DecodedTile {
  TileLayout layout;
  MapTile tile;                         ///< `key` and `origin` left alone
  std::vector<std::size_t> first_leaf;  ///< of each pass
  std::vector<TilePass> passes;         ///< if they were asked for
};

/// corrupt, limit_exceeded.
Result<DecodedTile> decode_tile(ByteSpan bytes, const TileLimits& limits, bool keep_trees);

}  // namespace curlidar::tile
