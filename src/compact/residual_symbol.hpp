// SPDX-License-Identifier: BSD-3-Clause
// How one residual becomes bits: zero flag, sign, class of magnitude, mantissa; each bit from a mix
// of adaptive contexts and of logistic distributions about the predictors.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "compact/residual_predictor.hpp"
#include "entropy/model.hpp"

namespace curlidar {

namespace residual_detail {

/// 2^32 / (1 + exp(i / 32)) for i = 0..416.
constexpr auto make_tail() {
  std::array<std::uint64_t, 417> table{};
  std::uint64_t power = std::uint64_t{1} << 32;  // exp(-i / 32)
  for (auto& value : table) {
    value = (power << 31) / ((std::uint64_t{1} << 31) + power / 2);
    power = (power * 4162829762u + (std::uint64_t{1} << 31)) >> 32;
  }
  return table;
}
inline constexpr auto kTail = make_tail();

/// Probability, in 1/2^32, of less than x, in 1/256 of the logistic distribution's scale.
inline std::uint64_t logistic_cdf(std::int64_t x) {
  const auto size = static_cast<std::uint64_t>(std::min<std::int64_t>(std::abs(x), 12 * 256));
  const std::size_t i = size >> 3;
  const std::uint64_t part = size & 7;
  const std::uint64_t tail = (kTail[i] * (8 - part) + kTail[i + 1] * part) >> 3;
  return x < 0 ? tail : (std::uint64_t{1} << 32) - tail;
}

}  // namespace residual_detail

/// Codes residuals, learning as it goes.
class ResidualSymbols {
 public:
  explicit ResidualSymbols(std::int32_t step);

  /// Contexts of one cell; call before code or cost.
  void set_cell(const RangePrediction& prediction);

  /// Codes q (ignored by a decoder) and learns.
  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t q) {
    return walk(q, Coder::kDecodes,
                [&](Node& node, bool bit) { return code_node(coder, node, bit); });
  }
  /// What code() would spend on q, in 1/256 bit.
  std::uint32_t cost(std::int32_t q) {
    std::uint32_t sum = 0;
    walk(q, false, [&](Node& node, bool bit) {
      sum += bit_cost(Mix<kInputs>(node.models, *node.weights).probability(), bit);
      return bit;
    });
    return sum;
  }

 private:
  static constexpr std::size_t kParametric = 4, kAdaptive = 6, kInputs = kParametric + kAdaptive;
  static constexpr std::size_t kNodes = 24, kSets = 6;
  static constexpr std::size_t kMaxClass = 30;
  static constexpr std::array<std::size_t, kAdaptive> kContexts = {24, 24 * 9, 512, 512, 512, 512};

  struct Node {
    std::array<BitModel, kParametric> shaped;
    std::array<BitModel*, kInputs> models;
    MixWeights<kInputs>* weights;
  };
  struct Shape {
    std::int64_t centre;      ///< of the distribution, against the prediction, doubled
    std::int64_t inverse;     ///< 2^25 * 256 / scale
    std::uint64_t low, high;  ///< cdf at the ends of the interval still open
  };

  std::uint64_t cdf(const Shape& shape, std::int64_t doubled) const {
    const std::int64_t x =
        std::clamp<std::int64_t>(doubled - shape.centre, -(1LL << 29), 1LL << 29);
    return residual_detail::logistic_cdf((x * shape.inverse) >> 26);
  }
  void aim(Node& node, std::size_t number, bool negative);
  static void set_share(BitModel& model, std::uint64_t ones, std::uint64_t zeros) {
    const std::uint64_t total = ones + zeros + 512;
    model.probability =
        static_cast<std::uint16_t>(std::min<std::uint64_t>(65535, ((ones + 256) << 16) / total));
  }

  template <class Coder>
  bool code_node(Coder& coder, Node& node, bool bit) {
    return code_bit(coder, node.models, *node.weights, 3, 255, bit);
  }

  /// Splits the open interval beyond magnitude `last`: is it greater?
  template <class Decide>
  bool split(Node& node, std::size_t number, bool negative, std::int64_t last, bool bit,
             const Decide& decide) {
    const std::int64_t bound = (2 * last + 1) * step_;
    std::array<std::uint64_t, kParametric> middle;
    for (std::size_t i = 0; i < kParametric; ++i) {
      const std::uint64_t below = cdf(shapes_[i], negative ? -bound : bound);
      middle[i] = negative ? (std::uint64_t{1} << 32) - below : below;
      set_share(node.shaped[i], shapes_[i].high - std::min(middle[i], shapes_[i].high),
                middle[i] - std::min(shapes_[i].low, middle[i]));
    }
    aim(node, number, negative);
    bit = decide(node, bit);
    for (std::size_t i = 0; i < kParametric; ++i)
      (bit ? shapes_[i].low : shapes_[i].high) = middle[i];
    return bit;
  }

  template <class Decide>
  std::int32_t walk(std::int32_t q, bool decodes, const Decide& decide);

  std::int64_t step_;
  std::array<std::size_t, kAdaptive> context_{};
  std::array<std::size_t, kAdaptive> signed_context_[2]{};
  std::size_t set_ = 0;
  std::array<Shape, kParametric> shapes_{};
  std::array<std::vector<BitModel>, kAdaptive> models_;
  std::vector<MixWeights<kInputs>> weights_;
};

template <class Decide>
std::int32_t ResidualSymbols::walk(std::int32_t q, bool decodes, const Decide& decide) {
  Node node;
  for (std::size_t i = 0; i < kParametric; ++i) node.models[i] = &node.shaped[i];
  constexpr std::uint64_t one = std::uint64_t{1} << 32;
  std::array<std::uint64_t, kParametric> below, above;
  for (std::size_t i = 0; i < kParametric; ++i) {
    below[i] = cdf(shapes_[i], -step_);
    above[i] = one - cdf(shapes_[i], step_);
    set_share(node.shaped[i], one - std::min(one, below[i] + above[i]), below[i] + above[i]);
  }
  aim(node, 0, false);
  if (decide(node, q == 0)) return 0;

  for (std::size_t i = 0; i < kParametric; ++i) set_share(node.shaped[i], below[i], above[i]);
  aim(node, 1, false);
  const bool negative = decide(node, q < 0);
  for (std::size_t i = 0; i < kParametric; ++i) {
    shapes_[i].low = one - (negative ? below[i] : above[i]);
    shapes_[i].high = one;
  }

  // Magnitude - 1 has `bits` significant bits.
  const auto target = static_cast<std::uint32_t>(decodes ? 0 : std::abs(q) - 1);
  const auto target_bits = static_cast<std::size_t>(std::bit_width(target));
  std::size_t bits = 0;
  while (bits < kMaxClass && split(node, 2 + std::min<std::size_t>(bits, 11), negative,
                                   std::int64_t{1} << bits, target_bits > bits, decide)) {
    ++bits;
  }
  std::uint32_t value = bits > 0 ? 1u << (bits - 1) : 0;
  for (std::size_t place = bits > 0 ? bits - 1 : 0; place-- > 0;) {
    const std::size_t depth = bits - 2 - place;
    const std::size_t number = depth == 0   ? 14 + std::min<std::size_t>(bits - 2, 7)
                               : depth == 1 ? 22
                                            : 23;
    const std::uint32_t bit = 1u << place;
    if (split(node, number, negative, value + bit, (target & bit) != 0, decide)) value += bit;
  }
  const auto magnitude = static_cast<std::int32_t>(value + 1);
  return negative ? -magnitude : magnitude;
}

}  // namespace curlidar
