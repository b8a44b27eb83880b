// SPDX-License-Identifier: BSD-3-Clause
#include "compact/residual_symbol.hpp"

namespace curlidar {
namespace {

/// 2 log2(1 + 4 value / unit), roughly: two classes an octave, at most `top`.
std::size_t size_class(std::int64_t value, std::int64_t unit, std::size_t top) {
  const auto x = static_cast<std::uint64_t>(1 + 4 * value / unit);
  const auto width = static_cast<std::size_t>(std::bit_width(x));
  const std::size_t half = width > 1 ? (x >> (width - 2)) & 1 : 0;
  return std::min(2 * (width - 1) + half, top);
}

/// -3..3 by the size of value against unit, as 0..6.
std::size_t signed_class(std::int64_t value, std::int64_t unit) {
  const std::int64_t size = std::abs(value);
  const int level = 4 * size < unit ? 0 : 2 * size < 2 * unit ? 1 : size < 3 * unit ? 2 : 3;
  return static_cast<std::size_t>(value < 0 ? 3 - level : 3 + level);
}

}  // namespace

ResidualSymbols::ResidualSymbols(std::int32_t step) : step_(step) {
  for (std::size_t k = 0; k < kAdaptive; ++k) models_[k].resize(kNodes * kContexts[k]);
  weights_.resize(kNodes * kSets);
  for (auto& w : weights_) {
    for (std::size_t i = 0; i < kInputs; ++i) w.weight[i] = i == 0 ? 30000 : 6000;
  }
}

void ResidualSymbols::set_cell(const RangePrediction& p) {
  constexpr std::array<std::size_t, kParametric> kShaped = {99, 2, 4, 5};
  for (std::size_t i = 0; i < kParametric; ++i) {
    const std::size_t k = kShaped[i];
    const std::int64_t centre = k < kResidualPredictors ? p.each[k] - p.range : 0;
    const std::int64_t spread = k < kResidualPredictors ? p.each_spread[k] : p.spread;
    const std::int64_t scale = spread * 45 / 64 + step_ / 8 + 1;
    shapes_[i].centre = 2 * centre;
    shapes_[i].inverse = (std::int64_t{256} << 25) / scale;
  }
  const std::size_t act = size_class(p.spread, step_, 23);
  set_ = std::min<std::size_t>(act / 3, kSets - 1);
  const std::int64_t unit = p.spread + step_ / 4 + 1;
  context_[0] = act;
  const auto grade = [&](std::uint32_t i) { return (p.known >> i & 1) + (p.same >> i & 1); };
  context_[1] = act * 9 + grade(0) * 3 + grade(1);
  context_[2] =
      size_class(p.last_error[0], step_, 21) * 22 + size_class(p.last_error[1], step_, 21);
  const std::size_t spreadness = size_class(std::abs(p.each[5] - p.each[1]), step_, 21);
  context_[3] = size_class(std::abs(p.each[0] - p.range), step_, 21) * 22 + spreadness;
  for (int s = 0; s < 2; ++s) {
    const int f = s ? -1 : 1;
    signed_context_[s][4] = signed_class(f * (p.each[5] - p.range), unit) * 7 +
                            signed_class(f * (p.each[4] - p.range), unit) +
                            49 * std::min<std::size_t>(act / 2, 9);
    signed_context_[s][5] = signed_class(f * (p.each[2] - p.range), unit) * 7 +
                            signed_class(f * (p.each[3] - p.range), unit) +
                            49 * std::min<std::size_t>(act / 2, 9);
  }
}

void ResidualSymbols::aim(Node& node, std::size_t number, bool negative) {
  for (std::size_t k = 0; k < kAdaptive; ++k) {
    const std::size_t context = k < 4 ? context_[k] : signed_context_[negative][k];
    node.models[kParametric + k] = &models_[k][number * kContexts[k] + context];
  }
  node.weights = &weights_[number * kSets + set_];
}

}  // namespace curlidar
