// SPDX-License-Identifier: BSD-3-Clause
// Logistic mixing by several weight sets at once, each chosen by a context of its own.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "entropy/logistic.hpp"

namespace curlidar {

/// Weights of the inputs of a mix. Learning happens in 1/2^20; a prediction takes them rounded to
/// 1/4096, which lets a compiler use 16-bit multiplications.
template <std::size_t Inputs>
class WeightSet {
 public:
  /// |weight| < 8.
  static constexpr std::int32_t kMaxWeight = (8 << 20) - 256;

  std::int32_t fine(std::size_t input) const { return fine_[input]; }
  void set(std::size_t input, std::int32_t weight) {
    fine_[input] = std::clamp(weight, -kMaxWeight, kMaxWeight);
    coarse_[input] = static_cast<std::int16_t>((fine_[input] + 128) >> 8);
  }

  /// Sum of weight times input, clamped to what squash() takes. The inputs' magnitudes must add up
  /// to less than 65536.
  std::int32_t dot(const std::array<std::int16_t, Inputs>& inputs) const {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < Inputs; ++i) sum += coarse_[i] * inputs[i];
    return std::clamp((sum + 2048) >> 12, -kStretchLimit, kStretchLimit);
  }

  /// Moves every weight by `pull` * input / 512, in 1/2^20.
  void learn(const std::array<std::int16_t, Inputs>& inputs, std::int16_t pull) {
    for (std::size_t i = 0; i < Inputs; ++i) {
      fine_[i] = std::clamp(fine_[i] + ((pull * inputs[i] + 256) >> 9), -kMaxWeight, kMaxWeight);
      coarse_[i] = static_cast<std::int16_t>((fine_[i] + 128) >> 8);
    }
  }

 private:
  std::array<std::int32_t, Inputs> fine_{};
  alignas(16) std::array<std::int16_t, Inputs> coarse_{};
};

/// The mean, in the logistic domain, of what several weight sets predict from the same inputs
/// (stretched probabilities, or any other evidence in 1/256 nat). Each set learns from its own
/// prediction's error. Needs no more than 8 sets.
template <std::size_t Inputs, std::size_t Sets>
class AveragedMix {
 public:
  AveragedMix(const std::array<std::int16_t, Inputs>& inputs,
              const std::array<WeightSet<Inputs>*, Sets>& sets)
      : inputs_(inputs), sets_(sets) {
    std::int32_t sum = 0;
    for (std::size_t s = 0; s < Sets; ++s) {
      predictions_[s] = sets[s]->dot(inputs);
      sum += predictions_[s];
    }
    constexpr std::int32_t part = (65536 + static_cast<std::int32_t>(Sets) / 2) / Sets;
    probability_ = squash((sum * part + 32768) >> 16);
  }

  /// Of a one, in 1/65536, within what the range coder takes.
  std::uint32_t probability() const { return probability_; }

  /// Learns from the bit that came. `rate` in 1/1024, at most 16. Sets that were all but certain
  /// and right (by less than 1/256) stay as they are, which saves most of the time.
  void update(bool bit, std::int32_t rate) {
    for (std::size_t s = 0; s < Sets; ++s) {
      const std::int32_t error =
          (bit ? 65536 : 0) - static_cast<std::int32_t>(squash(predictions_[s]));
      if (error > -256 && error < 256) continue;
      sets_[s]->learn(inputs_, static_cast<std::int16_t>((error * rate) >> 5));
    }
  }

 private:
  const std::array<std::int16_t, Inputs>& inputs_;
  const std::array<WeightSet<Inputs>*, Sets>& sets_;
  std::array<std::int32_t, Sets> predictions_;
  std::uint32_t probability_;
};

}  // namespace curlidar
