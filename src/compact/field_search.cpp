// SPDX-License-Identifier: BSD-3-Clause
#include "compact/field_search.hpp"

#include <limits>

namespace curlidar::compact {

CostTable::CostTable(const std::vector<BitModel>& models) {
  costs_.reserve(models.size());
  for (const BitModel& model : models) {
    const std::uint32_t p = std::clamp<std::uint32_t>(model.probability, 200, 65336);
    costs_.push_back({static_cast<std::uint16_t>(bit_cost(p, false)),
                      static_cast<std::uint16_t>(bit_cost(p, true))});
  }
}

void PartitionSearch::forget(const Block& block, std::size_t surfaces) {
  state_.surfaces.erase(state_.surfaces.begin() + static_cast<std::ptrdiff_t>(surfaces),
                        state_.surfaces.end());
  for (std::uint32_t i = 0; i < block.height; ++i) {
    const std::size_t begin = state_.cell(block.row + i, block.column);
    std::fill_n(state_.surface.begin() + static_cast<std::ptrdiff_t>(begin), block.width,
                kNoSurface);
  }
}

void PartitionSearch::place(const Node& node) {
  if (node.split != Split::none) {
    for (const Node& child : node.children) place(child);
    return;
  }
  std::vector<std::uint32_t> cells;
  state_.cells_of(node.block, cells);
  if (cells.empty()) return;
  const BlockContext context =
      block_context(state_, node.block, static_cast<std::uint32_t>(cells.size()));
  place_leaf(state_, surfaces_of(state_, context, node.leaf, cells), cells, node.labels);
}

std::int64_t PartitionSearch::search(Node& node) {
  std::vector<std::uint32_t> cells;
  state_.cells_of(node.block, cells);
  if (cells.empty()) return 0;
  const std::size_t surfaces = state_.surfaces.size();
  const BlockContext context =
      block_context(state_, node.block, static_cast<std::uint32_t>(cells.size()));
  SearchSink sink(costs_);
  const auto split_cost = [&](Split split) {
    sink.clear();
    code_split(sink, context, state_.settings, split);
    return sink.cost() * settings_.lambda;
  };
  std::int64_t best =
      search_leaf(state_, truth_, settings_, costs_, context, node) + split_cost(Split::none);
  node.split = Split::none;
  if (cells.size() > 1 && best > 4 * 256 * settings_.lambda) {
    for (const Split split : {Split::quad, Split::rows, Split::columns}) {
      if (!may_split(node.block, split, state_.settings)) continue;
      if (split != Split::quad && node.block.height >= settings_.binary_below &&
          may_split(node.block, Split::quad, state_.settings)) {
        continue;
      }
      std::int64_t cost = split_cost(split);
      std::vector<Node> children;
      for (const Block& block : children_of(node.block, split)) {
        children.push_back({block, {}, {}, {}, {}});
        cost += search(children.back());
        if (cost >= best) break;
      }
      forget(node.block, surfaces);
      if (cost >= best) continue;
      best = cost;
      node.split = split;
      node.children = std::move(children);
    }
  }
  if (node.split == Split::none) node.children.clear();
  place(node);
  return best;
}

}  // namespace curlidar::compact
