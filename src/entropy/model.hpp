// SPDX-License-Identifier: BSD-3-Clause
// Adaptive probabilities and their logistic mix.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "entropy/logistic.hpp"

namespace curlidar {

/// The probability of a one in a context, learnt as it goes: fast at first, then at a steady rate.
struct BitModel {
  std::uint16_t probability = 32768;  ///< of a one, in 1/65536
  std::uint16_t visits = 0;           ///< how much the probability rests on, saturates at a limit

  /// Moves towards `bit` by 1 / (visits + 1.5), at least 1 / (limit + 1.5).
  void update(bool bit, std::uint32_t limit) {
    const std::int32_t target = bit ? 65535 : 0;
    const std::int32_t rate = kRates[visits];
    probability = static_cast<std::uint16_t>(
        probability + (((target - probability) * static_cast<std::int64_t>(rate) + 32768) >> 16));
    if (visits < limit) ++visits;
  }

  static constexpr std::uint32_t kMaxLimit = 1023;
  /// round(65536 * 2 / (2 n + 3)).
  static constexpr auto kRates = [] {
    std::array<std::int32_t, kMaxLimit + 1> rates{};
    for (std::uint32_t n = 0; n <= kMaxLimit; ++n) {
      rates[n] = static_cast<std::int32_t>((2 * 65536 + n + 1) / (2 * n + 3));
    }
    return rates;
  }();
};

/// Probability clamped to what the range coder takes.
inline std::uint32_t coder_probability(std::uint32_t p) {
  constexpr std::uint32_t top = 65536 - kMinProbability;
  return p < kMinProbability ? kMinProbability : p > top ? top : p;
}

/// Weights of the inputs of a mix, 1 = 65536.
template <std::size_t Inputs>
struct MixWeights {
  std::array<std::int32_t, Inputs> weight;

  MixWeights() { weight.fill(static_cast<std::int32_t>(65536 * 5 / (4 * Inputs))); }
};

/// The logistic mix of several models' predictions (M. Mahoney, PAQ): squash(sum w_i stretch(p_i)),
/// weights moved down the gradient of the coding cost.
template <std::size_t Inputs>
class Mix {
 public:
  Mix(const std::array<BitModel*, Inputs>& models, MixWeights<Inputs>& weights)
      : models_(models), weights_(weights) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < Inputs; ++i) {
      stretched_[i] = stretch(models[i]->probability);
      sum += static_cast<std::int64_t>(weights.weight[i]) * stretched_[i];
    }
    const std::int64_t x = (sum + 32768) >> 16;
    probability_ = squash(static_cast<int>(x > kStretchLimit    ? kStretchLimit
                                           : x < -kStretchLimit ? -kStretchLimit
                                                                : x));
  }

  std::uint32_t probability() const { return probability_; }

  /// Learns from the bit that came. `rate` in 1/1024 (20 is usual), `limit` as BitModel::update's.
  void update(bool bit, std::int32_t rate, std::uint32_t limit) {
    const std::int64_t error = (bit ? 65536 : 0) - static_cast<std::int64_t>(probability_);
    for (std::size_t i = 0; i < Inputs; ++i) {
      const std::int64_t step = (error * stretched_[i] * rate + (1 << 17)) >> 18;
      std::int64_t weight = weights_.weight[i] + step;
      weight = weight > kMaxWeight ? kMaxWeight : weight < -kMaxWeight ? -kMaxWeight : weight;
      weights_.weight[i] = static_cast<std::int32_t>(weight);
      models_[i]->update(bit, limit);
    }
  }

 private:
  static constexpr std::int64_t kMaxWeight = 16 << 16;

  const std::array<BitModel*, Inputs>& models_;
  MixWeights<Inputs>& weights_;
  std::array<std::int32_t, Inputs> stretched_;
  std::uint32_t probability_;
};

/// A training coder has `observe(model, bit)` and sees every model that learns.
template <class Coder>
void observe(Coder& coder, const BitModel& model, bool bit) {
  if constexpr (requires { coder.observe(model, bit); }) coder.observe(model, bit);
}

/// Codes one bit with one model.
template <class Coder>
bool code_bit(Coder& coder, BitModel& model, std::uint32_t limit, bool bit) {
  bit = coder.code(coder_probability(model.probability), bit);
  observe(coder, model, bit);
  model.update(bit, limit);
  return bit;
}

/// Codes one bit with the mix of several models.
template <class Coder, std::size_t Inputs>
bool code_bit(Coder& coder, const std::array<BitModel*, Inputs>& models,
              MixWeights<Inputs>& weights, std::int32_t rate, std::uint32_t limit, bool bit) {
  Mix<Inputs> mix(models, weights);
  bit = coder.code(mix.probability(), bit);
  for (const BitModel* model : models) observe(coder, *model, bit);
  mix.update(bit, rate, limit);
  return bit;
}

/// A coder that only counts: the cost of what is coded, in 1/256 bit. Encoder only.
class CostCounter {
 public:
  static constexpr bool kDecodes = false;
  bool code(std::uint32_t probability_of_one, bool bit) {
    cost_ += bit_cost(probability_of_one, bit);
    return bit;
  }
  std::uint64_t cost() const { return cost_; }

 private:
  std::uint64_t cost_ = 0;
};

}  // namespace curlidar
