// SPDX-License-Identifier: BSD-3-Clause
// Finds the partition, layers and coefficients of a segment: the least J = sum |error| + lambda
// bits. Encoder only. Integers decide: errors in Q16 metres, costs in 1/256 bit.
#pragma once

#include <cstdint>
#include <vector>

#include "compact/field_code.hpp"

namespace curlidar::compact {

/// Cost in 1/256 bit of either value in each model; what a search believes the bits will cost.
class CostTable {
 public:
  explicit CostTable(const FieldModels& models);

  std::uint32_t cost(std::uint32_t model, bool value) const { return costs_[model][value]; }

 private:
  std::vector<std::array<std::uint16_t, 2>> costs_;
};

/// Counts with a CostTable; nothing adapts.
class SearchSink {
 public:
  static constexpr bool kDecodes = false;

  explicit SearchSink(const CostTable& table) : table_(table) {}
  bool bit(const Contexts& c, bool value) {
    cost_ += table_.cost(c.search, value);
    return value;
  }
  bool plain(FieldPart, bool value) {
    cost_ += 256;
    return value;
  }
  std::int64_t cost() const { return cost_; }
  void clear() { cost_ = 0; }

 private:
  const CostTable& table_;
  std::int64_t cost_ = 0;
};

/// How hard to search.
struct SearchSettings {
  std::int64_t lambda = 0;  ///< Q16 metres a bit
  std::uint32_t max_layers = 4;
  std::uint32_t max_functions = 3;   ///< place in kFunctions
  std::uint32_t fitted_parents = 2;  ///< parents that corrections are fitted on
  std::uint32_t reweighted_passes = 2;
  std::uint32_t layer_passes = 3;
  std::uint32_t binary_below = 32;  ///< squares of fewer cells a side are also tried halved
  /// Cost in J of a cell's error under a residual layer, by error * 8 / residual_step; empty = no
  /// residual layer.
  std::vector<std::int64_t> residual_costs;
  std::int32_t residual_step = 0;
};

/// The best partition below a block; the state is left as if the block had been coded so.
class PartitionSearch {
 public:
  PartitionSearch(FieldState& state, const std::vector<std::int32_t>& truth,
                  const SearchSettings& settings, const CostTable& costs)
      : state_(state), truth_(truth), settings_(settings), costs_(costs) {}

  /// J in Q16 metres / 256.
  std::int64_t search(Node& node);

 private:
  std::int64_t split_cost(const BlockContext& context, Split split) const;
  bool worth_trying(const Block& block, Split split) const;
  std::int64_t search_children(const BlockContext& context, Split split, std::int64_t bound,
                               std::vector<Node>& children);
  void place(const Node& node);

  FieldState& state_;
  const std::vector<std::int32_t>& truth_;
  const SearchSettings& settings_;
  const CostTable& costs_;
};

/// The best leaf for a block: its J, its code and labels in `node`.
std::int64_t search_leaf(FieldState& state, const std::vector<std::int32_t>& truth,
                         const SearchSettings& settings, const CostTable& costs,
                         const BlockContext& context, Node& node);

}  // namespace curlidar::compact
