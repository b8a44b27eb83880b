// SPDX-License-Identifier: BSD-3-Clause
// Random numbers that are the same on every machine: integer hashes, no std distributions.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace curlidar::scenery {

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection whose output bits all
/// depend on all input bits.
inline std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// A hash of a seed and a position, so that a draw belongs to its place and not to an order.
inline std::uint64_t keyed_bits(std::uint64_t seed, std::uint64_t a, std::uint64_t b,
                                std::uint64_t stream) {
  constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15u;
  std::uint64_t state = scramble(seed + kGolden);
  state = scramble(state ^ (a + kGolden * 2));
  state = scramble(state ^ (b + kGolden * 3));
  return scramble(state ^ (stream + kGolden * 4));
}

/// The top 53 bits as a double in [0, 1).
inline double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

/// A standard normal deviate from two independent words (Box and Muller 1958).
inline double gaussian(std::uint64_t radius_bits, std::uint64_t angle_bits) {
  const double u = 1 - unit_interval(radius_bits);  // in (0, 1], so that the logarithm is finite
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * unit_interval(angle_bits));
}

/// A sequence of draws, for placing things. Never use two draws in one expression outside braces:
/// compilers may evaluate operands in any order.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : key_(keyed_bits(seed, 0, 0, stream)) {}

  double uniform(double low, double high) { return low + (high - low) * unit_interval(next()); }
  bool chance(double probability) { return unit_interval(next()) < probability; }
  /// A whole number in [0, count).
  int below(int count) { return static_cast<int>(unit_interval(next()) * count); }

 private:
  std::uint64_t next() { return scramble(key_ + 0x9e3779b97f4a7c15u * ++counter_); }

  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace curlidar::scenery
