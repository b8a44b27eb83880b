// SPDX-License-Identifier: BSD-3-Clause
#include "compact/residual_symbols.hpp"

#include "entropy/embedded_priors.hpp"
#include "entropy/priors.hpp"

namespace curlidar::compact {
namespace {

constexpr std::int64_t kMixRate = 2;    // 1/1024
constexpr std::uint32_t kVisits = 255;  // limit of a model's
constexpr std::int32_t kMaxWeight = 16 << 16;

/// 2^32 / (1 + exp(i / 32)) for i = 0..385.
constexpr auto make_tail() {
  std::array<std::uint64_t, 386> table{};
  std::uint64_t power = std::uint64_t{1} << 32;  // exp(-i / 32) in 1/2^32
  for (std::uint64_t& value : table) {
    value = (power << 31) / ((std::uint64_t{1} << 31) + power / 2);
    power = (power * 4162829762u + (std::uint64_t{1} << 31)) >> 32;
  }
  return table;
}
constexpr auto kTail = make_tail();

/// Probability, in 1/2^32, of less than x, in 1/256 of the logistic distribution's scale.
std::uint64_t logistic_below(std::int64_t x) {
  const auto size = static_cast<std::uint64_t>(std::min<std::int64_t>(std::abs(x), 12 * 256));
  const auto i = static_cast<std::size_t>(size >> 3);
  const std::uint64_t part = size & 7;
  const std::uint64_t tail = (kTail[i] * (8 - part) + kTail[i + 1] * part) >> 3;
  return x < 0 ? tail : (std::uint64_t{1} << 32) - tail;
}

/// 2 log2(1 + 4 value / unit), roughly: two classes an octave, at most 23.
std::size_t size_class(std::int64_t value, std::int64_t unit) {
  const auto x = static_cast<std::uint64_t>(1 + 4 * value / unit);
  const auto width = static_cast<std::size_t>(std::bit_width(x));
  const std::size_t half = width > 1 ? (x >> (width - 2)) & 1 : 0;
  return std::min<std::size_t>(2 * (width - 1) + half, 23);
}

/// The size of a value against unit as -3..3, plus 3.
std::size_t signed_class(std::int64_t value, std::int64_t unit) {
  const std::int64_t size = std::abs(value);
  const int level = 4 * size < unit ? 0 : size < unit ? 1 : size < 3 * unit ? 2 : 3;
  return static_cast<std::size_t>(value < 0 ? 3 - level : 3 + level);
}

}  // namespace

ResidualSymbols::ResidualSymbols(std::int32_t step) : step_(step) {
  std::size_t contexts = 0;
  for (const std::size_t count : kContexts) contexts += count;
  models_.resize(kNodes * contexts);
  weights_.resize(kNodes * (kActivitySets + kGradeSets) * kInputs);
  apply_priors(embedded_priors("residual"), models_);
  apply_weight_priors(embedded_priors("residual_mix"), weights_);
}

void ResidualSymbols::set_cell(const RangePrediction& p, std::int32_t level) {
  const auto set_shape = [&](Shape& shape, std::int32_t guess, std::int64_t spread) {
    shape.centre = 2 * (std::int64_t{guess} - level);
    shape.inverse = (std::int64_t{1} << 33) / (spread * 45 / 64 + step_ / 8 + 1);
  };
  set_shape(shapes_[0], p.blend, p.blend_spread);
  set_shape(shapes_[1], p.of(Guess::filter), p.spread_of(Guess::filter));
  set_shape(shapes_[2], p.of(Guess::above), p.spread_of(Guess::above));
  set_shape(shapes_[3], p.of(Guess::texture), p.spread_of(Guess::texture));
  set_shape(shapes_[4], p.blend, 3 * std::int64_t{p.blend_spread});

  const std::size_t activity = size_class(p.blend_spread, step_);
  const std::size_t grades = 3 * p.grade_left + p.grade_above;
  set_ = {std::min(activity / 3, kActivitySets - 1), grades};
  const auto coarse = [&](std::int64_t value) { return size_class(std::abs(value), step_) / 3; };
  const std::int64_t unit = std::int64_t{p.blend_spread} + step_ / 4 + 1;
  for (int negative = 0; negative < 2; ++negative) {
    const auto side = [&](Guess guess) {
      const std::int64_t distance = std::int64_t{p.of(guess)} - level;
      return signed_class(negative ? -distance : distance, unit);
    };
    context_[static_cast<std::size_t>(negative)] = {
        activity,
        activity / 4 * 9 + grades,
        coarse(p.last_error_left) * 8 + coarse(p.last_error_above),
        coarse(std::int64_t{p.of(Guess::field)} - level) * 8 +
            coarse(std::int64_t{p.of(Guess::texture)} - p.of(Guess::mean)),
        std::min<std::size_t>(activity / 6, 3) * 49 + side(Guess::texture) * 7 + side(Guess::above),
        side(Guess::field) * 7 + side(Guess::filter)};
  }
}

/// Probability, in 1/2^32, of ranges below the level plus twice / 2.
std::uint64_t ResidualSymbols::below(const Shape& shape, std::int64_t twice) const {
  constexpr std::int64_t limit = 1 << 29;
  return logistic_below((std::clamp(twice - shape.centre, -limit, limit) * shape.inverse) >> 26);
}

/// The probability of a one, in 1/65536, when ones and zeros have these; a little of both is left.
std::uint32_t ResidualSymbols::share(std::uint64_t ones, std::uint64_t zeros) {
  return static_cast<std::uint32_t>(((ones + 256) << 16) / (ones + zeros + 512));
}

void ResidualSymbols::start_zero(Node& node, std::array<std::uint64_t, kShapes>& less,
                                 std::array<std::uint64_t, kShapes>& more) const {
  for (std::size_t i = 0; i < kShapes; ++i) {
    less[i] = below(shapes_[i], -step_);
    more[i] = kOne - below(shapes_[i], step_);
    const std::uint64_t other = less[i] + more[i];
    node.shaped[i] = share(kOne - std::min(kOne, other), other);
  }
}

void ResidualSymbols::divide(Node& node, bool negative, std::int64_t last,
                             std::array<std::uint64_t, kShapes>& middle) const {
  const std::int64_t bound = (2 * last + 1) * step_;
  for (std::size_t i = 0; i < kShapes; ++i) {
    const std::uint64_t under = below(shapes_[i], negative ? -bound : bound);
    middle[i] = std::clamp(negative ? kOne - under : under, shapes_[i].low, shapes_[i].high);
    node.shaped[i] = share(shapes_[i].high - middle[i], middle[i] - shapes_[i].low);
  }
}

void ResidualSymbols::aim(Node& node, std::size_t number, bool negative) {
  std::size_t begin = 0;
  for (std::size_t t = 0; t < kTables; ++t) {
    const std::size_t context = context_[negative && t >= kUnsignedTables][t];
    node.models[kShapes + t] = &models_[begin + number * kContexts[t] + context];
    begin += kNodes * kContexts[t];
  }
  node.weights[0] = &weights_[(number * kActivitySets + set_[0]) * kInputs];
  node.weights[1] = &weights_[(kNodes * kActivitySets + number * kGradeSets + set_[1]) * kInputs];
}

ResidualSymbols::Mixed::Mixed(const Node& node) {
  for (std::size_t i = 0; i < kInputs; ++i) {
    stretched[i] = stretch(i < kShapes ? node.shaped[i] : node.models[i]->probability);
  }
  for (std::size_t m = 0; m < 2; ++m) {
    std::int64_t total = 0;
    for (std::size_t i = 0; i < kInputs; ++i) {
      total += std::int64_t{node.weights[m][i]} * stretched[i];
    }
    sum[m] = static_cast<std::int32_t>(
        std::clamp<std::int64_t>((total + 32768) >> 16, -kStretchLimit, kStretchLimit));
  }
  probability = squash((sum[0] + sum[1]) >> 1);
}

/// Each mix moves its weights down the gradient of its own cost.
void ResidualSymbols::Mixed::learn(const Node& node, bool bit) const {
  for (std::size_t m = 0; m < 2; ++m) {
    const std::int64_t error = (bit ? 65536 : 0) - static_cast<std::int64_t>(squash(sum[m]));
    for (std::size_t i = 0; i < kInputs; ++i) {
      std::int32_t& weight = node.weights[m][i];
      weight += static_cast<std::int32_t>((error * stretched[i] * kMixRate + (1 << 17)) >> 18);
      weight = std::clamp(weight, -kMaxWeight, kMaxWeight);
    }
  }
  for (std::size_t i = kShapes; i < kInputs; ++i) node.models[i]->update(bit, kVisits);
}

}  // namespace curlidar::compact
