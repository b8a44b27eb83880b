// SPDX-License-Identifier: BSD-3-Clause
// The logistic domain: stretch(p) = ln(p / (1 - p)) in 1/256, squash its inverse, and bit costs.
// All tables come from 25 written-down constants by integer arithmetic (docs/format).
#pragma once

#include <array>
#include <cstdint>

#include "entropy/range_coder.hpp"

namespace curlidar {

/// stretch() lies in [-kStretchLimit, kStretchLimit], in 1/256: probabilities down to 6e-6.
inline constexpr int kStretchLimit = 3071;

namespace logistic_detail {

/// round(65536 / (1 + exp(-i / 2))) for i = 0..24.
inline constexpr std::array<std::uint32_t, 25> kKnots = {
    32768, 40793, 47911, 53581, 57724, 60565, 62428, 63615, 64357, 64816, 65097, 65269, 65374,
    65438, 65476, 65500, 65514, 65523, 65528, 65531, 65533, 65534, 65535, 65535, 65536};

constexpr std::uint32_t squash_positive(std::uint32_t x) {
  const std::uint32_t knot = x >> 7, part = x & 127;
  return kKnots[knot] + (((kKnots[knot + 1] - kKnots[knot]) * part + 64) >> 7);
}

constexpr std::uint32_t squash(int x) {
  const std::uint32_t p = x >= 0 ? squash_positive(static_cast<std::uint32_t>(x))
                                 : 65536 - squash_positive(static_cast<std::uint32_t>(-x));
  constexpr std::uint32_t top = 65536 - kMinProbability;
  return p < kMinProbability ? kMinProbability : p > top ? top : p;
}

constexpr auto make_squash() {
  std::array<std::uint16_t, 2 * kStretchLimit + 1> table{};
  for (int x = -kStretchLimit; x <= kStretchLimit; ++x) {
    table[static_cast<std::size_t>(x + kStretchLimit)] = static_cast<std::uint16_t>(squash(x));
  }
  return table;
}
inline constexpr auto kSquash = make_squash();

/// stretch of the middle of each of 4096 classes of probability: the least x whose squash reaches
/// it.
constexpr auto make_stretch() {
  std::array<std::int16_t, 4096> table{};
  int x = -kStretchLimit;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    while (x < kStretchLimit && kSquash[static_cast<std::size_t>(x + kStretchLimit)] < 16 * i + 8) {
      ++x;
    }
    table[i] = static_cast<std::int16_t>(x);
  }
  return table;
}
inline constexpr auto kStretch = make_stretch();

/// -log2((2 i + 1) / 8192) in 1/256 bit, by repeated squaring.
constexpr std::uint16_t cost_of_class(std::uint32_t i) {
  std::uint64_t mantissa = 2 * i + 1;  // in [1, 8192)
  int exponent = 0;
  while (mantissa < (1u << 31)) {
    mantissa <<= 1;
    ++exponent;
  }
  // value = mantissa / 2^31 * 2^(31 - exponent); log2 of the mantissa bit by bit.
  std::uint32_t fraction = 0;
  for (int bit = 0; bit < 10; ++bit) {
    mantissa = (mantissa * mantissa) >> 31;
    fraction <<= 1;
    if (mantissa >= (std::uint64_t{1} << 32)) {
      mantissa >>= 1;
      fraction |= 1;
    }
  }
  const int log2_q10 = ((31 - exponent) << 10) + static_cast<int>(fraction);
  return static_cast<std::uint16_t>(((13 << 10) - log2_q10 + 2) >> 2);
}

constexpr auto make_costs() {
  std::array<std::uint16_t, 4096> table{};
  for (std::uint32_t i = 0; i < 4096; ++i) table[i] = cost_of_class(i);
  return table;
}
inline constexpr auto kCosts = make_costs();

}  // namespace logistic_detail

/// Probability in 1/65536 of a stretched value; values beyond the limit are clamped.
inline std::uint32_t squash(int x) {
  x = x > kStretchLimit ? kStretchLimit : x < -kStretchLimit ? -kStretchLimit : x;
  return logistic_detail::kSquash[static_cast<std::size_t>(x + kStretchLimit)];
}
/// Stretched value of a probability in (0, 65536).
inline int stretch(std::uint32_t probability) {
  return logistic_detail::kStretch[probability >> 4];
}
/// Cost in 1/256 bit of coding `bit` with this probability of a one. Encoder only.
inline std::uint32_t bit_cost(std::uint32_t probability_of_one, bool bit) {
  return logistic_detail::kCosts[(bit ? probability_of_one : 65535 - probability_of_one) >> 4];
}

}  // namespace curlidar
