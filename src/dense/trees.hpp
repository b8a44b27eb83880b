// SPDX-License-Identifier: BSD-3-Clause
// Boosted oblivious decision trees: every level of a tree asks one question of all its branches, so
// that a tree is a few comparisons and one look-up. Small integers throughout.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curlidar/result.hpp"

namespace curlidar {

inline constexpr std::size_t kMaxTreeFeatures = 256, kMaxTrees = 1024, kMaxTreeDepth = 8;
inline constexpr double kMaxTreeNumber = 1e6;  ///< of base and unit

struct ObliviousTrees {
  /// A question: is the level of the feature above this one?
  struct Split {
    std::uint8_t feature = 0, level = 0;
    friend bool operator==(const Split&, const Split&) = default;
  };

  /// Of each feature, strictly ascending, at most 255. The level of a value is the number of cuts
  /// below it.
  std::vector<std::vector<float>> cuts;
  std::size_t depth = 0;             ///< splits of each tree
  std::vector<Split> splits;         ///< `depth` for each tree; bit i of a leaf's number is split i
  std::vector<std::int16_t> leaves;  ///< 2^depth for each tree
  double base = 0, unit = 0;         ///< a value is base + unit * the sum of leaves

  std::size_t features() const { return cuts.size(); }
  std::size_t trees() const { return depth == 0 ? 0 : splits.size() / depth; }
  bool empty() const { return splits.empty(); }

  /// The level of every feature's value; both have features() entries. NaN has level 0.
  void quantise(std::span<const float> values, std::span<std::uint8_t> levels) const;
  /// What the trees say; `levels` as quantise() made them. O(trees * depth).
  double evaluate(std::span<const std::uint8_t> levels) const;
  /// Both in one; values has features() entries.
  double operator()(std::span<const float> values) const;

  friend bool operator==(const ObliviousTrees&, const ObliviousTrees&) = default;
};

/// Checks everything that evaluation relies on. Errors: invalid_argument.
Status validate(const ObliviousTrees& trees);

/// 1 / (1 + exp(-x)): what trees of probabilities say as a probability.
double probability_of(double log_odds);

}  // namespace curlidar
