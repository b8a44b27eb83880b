// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_search.hpp"

#include <algorithm>
#include <limits>

namespace curlidar::tile {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
/// A leaf that costs no more bits than the least split would is left alone.
constexpr double kLeastSplit = 6;

}  // namespace

double TileSearch::cost_left(std::size_t begin, std::size_t end) const {
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += samples_.left[i];
  return sum;
}

double TileSearch::occupied_cost(const CubeContext& c, std::uint32_t siblings,
                                 bool occupied) const {
  TileCost cost(models_);
  code_occupied(cost, c, siblings, occupied);
  return weighing_.lambda * cost.bits();
}

double TileSearch::split_cost(const CubeContext& c, bool split) const {
  if (c.cube.level >= state_.layout().levels) return split ? kNever : 0;
  TileCost cost(models_);
  code_split(cost, c, split);
  return weighing_.lambda * cost.bits();
}

std::int32_t TileSearch::root(const CubeContext& c, const RootSamples& root) {
  nodes_.clear();
  const double left = cost_left(root.begin, root.end);
  if (left < weighing_.least) return -1;
  const TileState::Mark mark = state_.mark();
  const Found found = search(c, root.begin, root.end);
  const double without = left + occupied_cost(c, 0, false);
  if (found.node >= 0 && found.cost + occupied_cost(c, 0, true) < without) return found.node;
  state_.forget(c.cube, mark);
  return -1;
}

TileSearch::Found TileSearch::search(const CubeContext& c, std::size_t begin, std::size_t end) {
  const TileState::Mark mark = state_.mark();
  TriedLeaf leaf =
      best_leaf(state_, models_, weighing_, c, {&samples_, begin, end, c.centre, c.half});
  leaf.cost += split_cost(c, false);
  if (c.cube.level < state_.layout().levels && leaf.cost > kLeastSplit * weighing_.lambda) {
    const std::size_t nodes = nodes_.size();
    const Found found = split(c, begin, end, leaf.cost);
    if (found.cost < leaf.cost) return found;
    nodes_.resize(nodes);
    state_.forget(c.cube, mark);
  }
  if (leaf.cost == kNever) return {-1, kNever};
  state_.place(c, leaf.code);
  nodes_.push_back({false, std::move(leaf.code), {}});
  return {static_cast<std::int32_t>(nodes_.size() - 1), leaf.cost};
}

TileSearch::Found TileSearch::split(const CubeContext& c, std::size_t begin, std::size_t end,
                                    double bound) {
  TileNode node;
  node.split = true;
  double total = split_cost(c, true);
  const std::uint32_t shift = 3 * (state_.layout().levels - c.cube.level - 1);
  std::uint32_t siblings = 0;
  for (std::uint32_t k = 0; k < 8; ++k) {
    if (total >= bound) return {-1, kNever};
    std::size_t last = begin;
    while (last < end && (samples_.fine[last] >> shift & 7) == k) ++last;
    const CubeContext child = state_.context(c.cube.child(k));
    const double left = cost_left(begin, last);
    const double out = left + occupied_cost(child, siblings, false);
    node.children[k] = -1;
    if (last > begin && left >= weighing_.least) {
      const TileState::Mark mark = state_.mark();
      const std::size_t nodes = nodes_.size();
      const Found found = search(child, begin, last);
      const double in = found.cost + occupied_cost(child, siblings, true);
      if (found.node >= 0 && in < out) {
        node.children[k] = found.node;
        total += in;
        ++siblings;
      } else {
        state_.forget(child.cube, mark);
        nodes_.resize(nodes);
      }
    }
    if (node.children[k] < 0) {
      state_.set_empty(child.cube);
      total += out;
    }
    begin = last;
  }
  if (siblings == 0) return {-1, kNever};
  nodes_.push_back(node);
  return {static_cast<std::int32_t>(nodes_.size() - 1), total};
}

}  // namespace curlidar::tile
