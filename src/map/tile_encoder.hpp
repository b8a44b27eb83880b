// SPDX-License-Identifier: BSD-3-Clause
// A tile's encoder: root after root is searched with what the models have learnt so far, and coded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/map_settings.hpp"
#include "curlidar/result.hpp"
#include "map/tile_tree.hpp"

namespace curlidar::tile {

/// What was chosen for a root: `nodes[node]`, nothing for -1.
struct RootTree {
  std::vector<TileNode> nodes;
  std::int32_t node = -1;
};

struct EncodedTile {
  std::vector<std::byte> bytes;
  TileLayout layout;
  std::vector<RootTree> roots;  ///< all, in their order, if they were asked for
};

/// Errors as encode_surface_tile's.
Result<EncodedTile> encode_tile(const std::vector<MapSample>& samples,
                                const SurfaceSettings& settings, double side_m,
                                bool keep_roots = false);

/// Codes trees that were chosen before.
template <class Sink>
void code_trees(Sink& sink, const TileLayout& layout, const std::vector<RootTree>& roots) {
  TileState state(layout);
  std::size_t next = 0;
  for_each_root(layout, [&](const TileCube& cube) {
    const RootTree& root = roots[next++];
    return code_root(sink, state, state.context(cube), &root.nodes, root.node, [] { return true; });
  });
}

}  // namespace curlidar::tile
