// SPDX-License-Identifier: BSD-3-Clause
#include "dense/trees.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace curlidar {

namespace {

/// The number of cuts below a value, without a branch that could be guessed wrongly; NaN lies below
/// all of them.
std::size_t cuts_below(const std::vector<float>& cuts, float value) {
  const float* at = cuts.data();
  std::size_t left = cuts.size();
  while (left > 1) {
    const std::size_t half = left / 2;
    at += half * static_cast<std::size_t>(value > at[half - 1]);
    left -= half;
  }
  const std::size_t passed = static_cast<std::size_t>(at - cuts.data());
  return passed + static_cast<std::size_t>(left == 1 && value > *at);
}

}  // namespace

void ObliviousTrees::quantise(std::span<const float> values, std::span<std::uint8_t> levels) const {
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    levels[i] = static_cast<std::uint8_t>(cuts_below(cuts[i], values[i]));
  }
}

double ObliviousTrees::evaluate(std::span<const std::uint8_t> levels) const {
  std::int64_t sum = 0;
  const Split* split = splits.data();
  const std::int16_t* leaf = leaves.data();
  for (std::size_t tree = trees(); tree > 0; --tree, leaf += std::size_t{1} << depth) {
    std::size_t number = 0;
    for (std::size_t i = 0; i < depth; ++i, ++split) {
      number |= std::size_t{levels[split->feature] > split->level} << i;
    }
    sum += leaf[number];
  }
  return base + unit * static_cast<double>(sum);
}

double ObliviousTrees::operator()(std::span<const float> values) const {
  std::array<std::uint8_t, kMaxTreeFeatures> levels;
  quantise(values, levels);
  return evaluate(levels);
}

Status validate(const ObliviousTrees& trees) {
  const auto invalid = [](std::string what) {
    return Error{ErrorCode::invalid_argument, "trees: " + std::move(what)};
  };
  if (trees.cuts.empty() || trees.cuts.size() > kMaxTreeFeatures) {
    return invalid(fmt::format("there must be 1 to {} features", kMaxTreeFeatures));
  }
  for (std::size_t i = 0; i < trees.cuts.size(); ++i) {
    const std::vector<float>& cuts = trees.cuts[i];
    const auto bad = [](float a, float b) { return !(a < b); };
    if (cuts.size() > 255 || std::adjacent_find(cuts.begin(), cuts.end(), bad) != cuts.end() ||
        !std::all_of(cuts.begin(), cuts.end(), [](float cut) { return std::isfinite(cut); })) {
      return invalid(fmt::format("feature {} needs at most 255 ascending finite cuts", i));
    }
  }
  if (trees.depth < 1 || trees.depth > kMaxTreeDepth) {
    return invalid(fmt::format("the depth must be 1 to {}", kMaxTreeDepth));
  }
  if (trees.splits.size() % trees.depth != 0 || trees.trees() < 1 || trees.trees() > kMaxTrees) {
    return invalid(fmt::format("there must be 1 to {} trees of {} splits", kMaxTrees, trees.depth));
  }
  for (const ObliviousTrees::Split& split : trees.splits) {
    if (split.feature >= trees.cuts.size()) {
      return invalid(
          fmt::format("a split asks for feature {} of {}", split.feature, trees.cuts.size()));
    }
  }
  if (trees.leaves.size() != trees.trees() << trees.depth) {
    return invalid(fmt::format("{} trees need {} leaves, not {}", trees.trees(),
                               trees.trees() << trees.depth, trees.leaves.size()));
  }
  if (!(std::abs(trees.base) <= kMaxTreeNumber && std::abs(trees.unit) <= kMaxTreeNumber)) {
    return invalid(fmt::format("base and unit must be numbers up to {:g}", kMaxTreeNumber));
  }
  return {};
}

double probability_of(double log_odds) {
  return 1 / (1 + std::exp(-log_odds));
}

}  // namespace curlidar
