// SPDX-License-Identifier: BSD-3-Clause
// The octree of a tile as a syntax: what is occupied, what is split, and the leaves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "map/tile_syntax.hpp"

namespace curlidar::tile {

/// A cube as an encoder chose it.
struct TileNode {
  bool split = false;
  TileLeafCode leaf;
  std::array<std::int32_t, 8> children{-1, -1, -1, -1, -1, -1, -1, -1};  ///< -1: empty
};

/// What is in a root: `nodes[node]`, nothing for -1.
struct RootTree {
  std::vector<TileNode> nodes;
  std::int32_t node = -1;
};
/// A walk over all roots of a tile, in their order.
using TilePass = std::vector<RootTree>;
/// Passes that a tile may have.
inline constexpr std::size_t kMostPasses = 16;

/// Codes cubes below a root. A decoder has no nodes; `go_on` is asked before every leaf. `found`
/// takes what was coded if it is not null.
template <class Sink, class GoOn>
class TreeCoder {
 public:
  TreeCoder(Sink& sink, TileState& state, const std::vector<TileNode>* nodes, const GoOn& go_on,
            RootTree* found = nullptr)
      : sink_(sink), state_(state), nodes_(nodes), go_on_(go_on), found_(found) {}

  /// False where go_on said so.
  bool code(const CubeContext& c, std::int32_t node) {
    const TileNode* known =
        nodes_ == nullptr ? nullptr : &(*nodes_)[static_cast<std::size_t>(node)];
    bool split = known != nullptr && known->split;
    if (c.cube.level < state_.layout().levels) split = code_split(sink_, c, split);
    if (split) return code_children(c.cube, known);
    if (!go_on_()) return false;
    TileLeafCode leaf;
    if (known != nullptr) leaf = known->leaf;
    code_leaf(sink_, state_, c, leaf);
    state_.place(c, leaf);
    keep({false, std::move(leaf), {}});
    return true;
  }

 private:
  bool code_children(const TileCube& cube, const TileNode* known) {
    std::uint32_t siblings = 0;
    TileNode node{true, {}, {-1, -1, -1, -1, -1, -1, -1, -1}};
    for (std::uint32_t k = 0; k < 8; ++k) {
      const CubeContext c = state_.context(cube.child(k));
      const std::int32_t child = known == nullptr ? -1 : known->children[k];
      bool occupied = child >= 0;
      // A split cube is not empty.
      if (k == 7 && siblings == 0) {
        occupied = true;
      } else {
        occupied = code_occupied(sink_, c, siblings, occupied);
      }
      if (!occupied) {
        state_.set_empty(c.cube);
        continue;
      }
      ++siblings;
      if (!code(c, child)) return false;
      if (found_ != nullptr) node.children[k] = found_->node;
    }
    keep(std::move(node));
    return true;
  }

  void keep(TileNode node) {
    if (found_ == nullptr) return;
    found_->nodes.push_back(std::move(node));
    found_->node = static_cast<std::int32_t>(found_->nodes.size() - 1);
  }

  Sink& sink_;
  TileState& state_;
  const std::vector<TileNode>* nodes_;
  const GoOn& go_on_;
  RootTree* found_;
};

/// Codes a root and what is below it; `node` -1 is empty. False where `go_on` said so.
template <class Sink, class GoOn>
bool code_root(Sink& sink, TileState& state, const CubeContext& c,
               const std::vector<TileNode>* nodes, std::int32_t node, const GoOn& go_on,
               RootTree* found = nullptr) {
  if (!code_occupied(sink, c, 0, node >= 0)) {
    state.set_empty(c.cube);
    return true;
  }
  return TreeCoder<Sink, GoOn>(sink, state, nodes, go_on, found).code(c, node);
}

/// All roots in their order: calls body(cube) until it says false.
template <class Body>
bool for_each_root(const TileLayout& layout, const Body& body) {
  for (std::uint32_t x = 0; x < layout.side_roots; ++x) {
    for (std::uint32_t y = 0; y < layout.side_roots; ++y) {
      for (std::uint32_t z = 0; z < layout.rows; ++z) {
        if (!body(TileCube{0, {x, y, z}})) return false;
      }
    }
  }
  return true;
}

}  // namespace curlidar::tile
