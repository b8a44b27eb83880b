// SPDX-License-Identifier: BSD-3-Clause
// How one residual becomes bits: zero flag, sign, class of magnitude, mantissa; each bit from a mix
// of adaptive contexts and of logistic distributions about the guesses.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "compact/residual_predictor.hpp"
#include "entropy/model.hpp"

namespace curlidar::compact {

/// Codes residuals of one segment, learning as it goes.
class ResidualSymbols {
 public:
  /// Levels lie `step` apart.
  explicit ResidualSymbols(std::int32_t step);

  /// The contexts of one cell, whose residuals count from `level`; call before code or cost.
  void set_cell(const RangePrediction& prediction, std::int32_t level);

  /// Codes a residual in [-2^30, 2^30] (ignored by a decoder) and learns.
  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t residual) {
    return walk(residual, [&](const Node& node, bool bit) {
      Mixed mixed(node);
      bit = coder.code(mixed.probability, bit);
      for (std::size_t i = kShapes; i < kInputs; ++i) observe(coder, *node.models[i], bit);
      mixed.learn(node, bit);
      return bit;
    });
  }
  /// What code() would spend on a residual, in 1/256 bit.
  std::uint32_t cost(std::int32_t residual) {
    std::uint32_t sum = 0;
    walk(residual, [&](const Node& node, bool bit) {
      sum += bit_cost(Mixed(node).probability, bit);
      return bit;
    });
    return sum;
  }

  /// All that is learnt, in the order of the table of priors.
  std::span<BitModel> models() { return models_; }
  std::span<std::int32_t> weights() { return weights_; }

 private:
  static constexpr std::size_t kShapes = 5, kTables = 6, kInputs = kShapes + kTables;
  static constexpr std::size_t kNodes = 18;
  /// Contexts of each table.
  static constexpr std::array<std::size_t, kTables> kContexts = {24, 54, 64, 64, 196, 49};
  /// The first tables know nothing of the sign; the others look along the residual's.
  static constexpr std::size_t kUnsignedTables = 4;
  /// Sets of weights of the two mixes: by activity and by grade of the neighbours.
  static constexpr std::size_t kActivitySets = 6, kGradeSets = 9;
  static constexpr std::size_t kMaxClass = 30;
  static constexpr std::uint64_t kOne = std::uint64_t{1} << 32;

  /// One binary decision: its inputs and the weights of its two mixes.
  struct Node {
    std::array<std::uint32_t, kShapes> shaped{};  ///< probability of a one by each shape
    std::array<BitModel*, kInputs> models{};      ///< from kShapes on
    std::array<std::int32_t*, 2> weights{};
  };
  struct Mixed {
    explicit Mixed(const Node& node);
    void learn(const Node& node, bool bit) const;

    std::array<std::int32_t, kInputs> stretched;
    std::array<std::int32_t, 2> sum;
    std::uint32_t probability;
  };
  /// A logistic distribution of the range about a guess.
  struct Shape {
    std::int64_t centre = 0;          ///< twice its distance from the level
    std::int64_t inverse = 0;         ///< 2^33 / scale
    std::uint64_t low = 0, high = 0;  ///< probability below the ends of the open interval
  };

  std::uint64_t below(const Shape& shape, std::int64_t twice) const;
  void aim(Node& node, std::size_t number, bool negative);
  void start_zero(Node& node, std::array<std::uint64_t, kShapes>& less,
                  std::array<std::uint64_t, kShapes>& more) const;
  static std::uint32_t share(std::uint64_t ones, std::uint64_t zeros);
  void divide(Node& node, bool negative, std::int64_t last,
              std::array<std::uint64_t, kShapes>& middle) const;

  /// Is the magnitude, in the open interval, greater than `last`?
  template <class Decide>
  bool split(Node& node, std::size_t number, bool negative, std::int64_t last, bool bit,
             const Decide& decide) {
    std::array<std::uint64_t, kShapes> middle;
    divide(node, negative, last, middle);
    aim(node, number, negative);
    bit = decide(node, bit);
    for (std::size_t i = 0; i < kShapes; ++i) (bit ? shapes_[i].low : shapes_[i].high) = middle[i];
    return bit;
  }
  template <class Decide>
  std::int32_t walk(std::int32_t residual, const Decide& decide);

  std::int64_t step_;
  std::array<std::array<std::size_t, kTables>, 2> context_{};  ///< by sign
  std::array<std::size_t, 2> set_{};
  std::array<Shape, kShapes> shapes_{};
  std::vector<BitModel> models_;       ///< [table][node][context]
  std::vector<std::int32_t> weights_;  ///< [node][activity][input], then [node][grade][input]
};

template <class Decide>
std::int32_t ResidualSymbols::walk(std::int32_t residual, const Decide& decide) {
  Node node;
  std::array<std::uint64_t, kShapes> less, more;
  start_zero(node, less, more);
  aim(node, 0, false);
  if (decide(node, residual == 0)) return 0;

  for (std::size_t i = 0; i < kShapes; ++i) node.shaped[i] = share(less[i], more[i]);
  aim(node, 1, false);
  const bool negative = decide(node, residual < 0);
  for (std::size_t i = 0; i < kShapes; ++i) {
    shapes_[i].low = kOne - (negative ? less[i] : more[i]);
    shapes_[i].high = kOne;
  }

  // Magnitude - 1 has `bits` significant bits.
  const auto target = static_cast<std::uint32_t>(std::abs(residual) - 1);
  const auto target_bits = static_cast<std::size_t>(std::bit_width(target));
  std::size_t bits = 0;
  while (bits < kMaxClass && split(node, 2 + std::min<std::size_t>(bits, 9), negative,
                                   std::int64_t{1} << bits, target_bits > bits, decide)) {
    ++bits;
  }
  std::uint32_t value = bits > 0 ? 1u << (bits - 1) : 0;
  for (std::size_t place = bits > 0 ? bits - 1 : 0; place-- > 0;) {
    const bool top = place + 2 == bits;
    const std::uint32_t bit = 1u << place;
    if (split(node, top ? 12 + std::min<std::size_t>(bits - 2, 4) : 17, negative, value + bit,
              (target & bit) != 0, decide)) {
      value += bit;
    }
  }
  const auto magnitude = static_cast<std::int32_t>(value + 1);
  return negative ? -magnitude : magnitude;
}

}  // namespace curlidar::compact
