// SPDX-License-Identifier: BSD-3-Clause
#include "compact/field_search.hpp"

#include <algorithm>
#include <utility>

namespace curlidar::compact {

CostTable::CostTable(const FieldModels& models) {
  const std::size_t count = models.guided() ? kSearchModels : models.models.size();
  costs_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t p = std::clamp<std::uint32_t>(models.models[i].probability, 200, 65336);
    costs_.push_back({static_cast<std::uint16_t>(bit_cost(p, false)),
                      static_cast<std::uint16_t>(bit_cost(p, true))});
  }
}

void PartitionSearch::place(const Node& node) {
  if (node.split != Split::none) {
    for (const Node& child : node.children) place(child);
    return;
  }
  const std::vector<std::uint32_t> cells = state_.cells_of(node.block);
  if (cells.empty()) return;
  const BlockContext context =
      block_context(state_, node.block, static_cast<std::uint32_t>(cells.size()));
  place_leaf(state_, surfaces_of(state_, context, node.leaf, cells), cells, node.labels);
}

std::int64_t PartitionSearch::search(Node& node) {
  const std::vector<std::uint32_t> cells = state_.cells_of(node.block);
  if (cells.empty()) return 0;
  const std::size_t surfaces = state_.surfaces.size();
  const BlockContext context =
      block_context(state_, node.block, static_cast<std::uint32_t>(cells.size()));
  std::int64_t best = search_leaf(state_, truth_, settings_, costs_, context, node) +
                      split_cost(context, Split::none);
  // A leaf that costs no more than the least split would is left alone.
  constexpr std::int64_t kLeastSplit = 4 * 256;
  if (cells.size() > 1 && best > kLeastSplit * settings_.lambda) {
    for (const Split split : {Split::quad, Split::rows, Split::columns}) {
      if (!worth_trying(node.block, split)) continue;
      std::vector<Node> children;
      const std::int64_t cost = search_children(context, split, best, children);
      state_.forget(node.block, surfaces);
      if (cost >= best) continue;
      best = cost;
      node.split = split;
      node.children = std::move(children);
    }
  }
  place(node);
  return best;
}

std::int64_t PartitionSearch::split_cost(const BlockContext& context, Split split) const {
  SearchSink sink(costs_);
  code_split(sink, context, state_.settings, split);
  return sink.cost() * settings_.lambda;
}

bool PartitionSearch::worth_trying(const Block& block, Split split) const {
  if (!may_split(block, split, state_.settings)) return false;
  return split == Split::quad || block.height < settings_.binary_below ||
         !may_split(block, Split::quad, state_.settings);
}

/// J of a split and of what is below it, at least `bound` if that is reached.
std::int64_t PartitionSearch::search_children(const BlockContext& context, Split split,
                                              std::int64_t bound, std::vector<Node>& children) {
  std::int64_t cost = split_cost(context, split);
  for (const Block& block : children_of(context.block, split)) {
    if (cost >= bound) break;
    children.push_back({block, {}, {}, {}, {}});
    cost += search(children.back());
  }
  return cost;
}

}  // namespace curlidar::compact
