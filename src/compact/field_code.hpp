// SPDX-License-Identifier: BSD-3-Clause
// Walks a segment's field in the order of the format: roots row by row, the partition of each, its
// leaves. One walk for reading, writing and counting.
#pragma once

#include <cstdint>
#include <vector>

#include "compact/field_state.hpp"
#include "compact/field_syntax.hpp"

namespace curlidar::compact {

/// A block of the partition: split into children, or a leaf.
struct Node {
  Block block;
  Split split = Split::none;
  std::vector<Node> children;
  LeafCode leaf;
  std::vector<std::uint8_t> labels;  ///< of the leaf's returns in raster order; empty = all 0
};

/// The blocks that a split makes, in the order of the format.
inline std::vector<Block> children_of(const Block& b, Split split) {
  const std::uint32_t h = (b.height + 1) / 2, w = (b.width + 1) / 2;
  const std::uint32_t row = b.row + h, column = b.column + w;
  switch (split) {
    case Split::quad:
      return {{b.row, b.column, h, w},
              {b.row, column, h, b.width - w},
              {row, b.column, b.height - h, w},
              {row, column, b.height - h, b.width - w}};
    case Split::rows:
      return {{b.row, b.column, h, b.width}, {row, b.column, b.height - h, b.width}};
    case Split::columns:
      return {{b.row, b.column, b.height, w}, {b.row, column, b.height, b.width - w}};
    case Split::none:
      break;
  }
  return {};
}

/// The roots of a segment, row by row.
std::vector<Block> roots_of(const Geometry& geometry, const FieldSettings& settings);

/// A leaf's surfaces and what they say of each of its returns.
struct LeafSurfaces {
  std::vector<PlacedSurface> layers;
  std::vector<LayerRanges> ranges;  ///< one for each cell
};
LeafSurfaces surfaces_of(FieldState& state, const BlockContext& context, const LeafCode& leaf,
                         const std::vector<std::uint32_t>& cells);

/// Adds a leaf's surfaces to the state and gives each cell its layer's range.
void place_leaf(FieldState& state, LeafSurfaces&& surfaces, const std::vector<std::uint32_t>& cells,
                const std::vector<std::uint8_t>& labels);

template <class Sink>
void code_labels(Sink& sink, const FieldState& state, const Block& block, std::uint32_t layers,
                 const LeafSurfaces& surfaces, const std::vector<std::uint32_t>& cells,
                 std::vector<std::uint8_t>& labels) {
  labels.resize(cells.size());
  LabelContexts contexts(state, block, layers);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const LabelContext context = contexts.at(cells[i], surfaces.ranges[i]);
    labels[i] = static_cast<std::uint8_t>(code_label(sink, context, layers, labels[i]));
    contexts.set(cells[i], labels[i]);
  }
}

/// Codes a block and what it holds; a reading sink fills `node`.
template <class Sink>
void code_node(Sink& sink, FieldState& state, Node& node) {
  const std::vector<std::uint32_t> cells = state.cells_of(node.block);
  if (cells.empty()) return;
  const auto returns = static_cast<std::uint32_t>(cells.size());
  const BlockContext context = block_context(state, node.block, returns);
  node.split = code_split(sink, context, state.settings, node.split);
  if (node.split != Split::none) {
    if constexpr (Sink::kDecodes) {
      node.children.clear();
      for (const Block& block : children_of(node.block, node.split)) {
        node.children.push_back({block, {}, {}, {}, {}});
      }
    }
    for (Node& child : node.children) code_node(sink, state, child);
    return;
  }
  code_leaf(sink, context, returns, node.leaf);
  LeafSurfaces surfaces = surfaces_of(state, context, node.leaf, cells);
  if (node.leaf.layers > 1) {
    code_labels(sink, state, node.block, node.leaf.layers, surfaces, cells, node.labels);
  } else {
    node.labels.clear();
  }
  place_leaf(state, std::move(surfaces), cells, node.labels);
}

}  // namespace curlidar::compact
