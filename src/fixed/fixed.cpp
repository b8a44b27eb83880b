// SPDX-License-Identifier: BSD-3-Clause
#include "fixed/fixed.hpp"

#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

namespace curlidar {
namespace {

// C_k = round(2^33 (pi/4)^k / k!), highest first.
constexpr std::uint64_t kCosine[] = {211, 30845, 2800249, 136187780, 2649351758, 8589934592};
constexpr std::uint64_t kSine[] = {15, 2692, 314187, 21392326, 693598668, 6746518852};

constexpr std::uint32_t kEighthTurn = std::uint32_t{1} << 29;
constexpr std::uint32_t kQuarterTurn = std::uint32_t{1} << 30;

/// Alternating polynomial in u (Q32, at most 1) by Horner's rule. The partial sums before the last
/// are positive and below 2^32, so that products stay below 2^64.
template <std::size_t N>
constexpr std::uint64_t alternating(const std::uint64_t (&coefficients)[N], std::uint64_t u) {
  std::uint64_t sum = coefficients[0];
  for (std::size_t i = 1; i < N; ++i) sum = coefficients[i] - ((u * sum) >> 32);
  return sum;
}

/// Of an angle of at most an eighth turn.
SinCos sin_cos_of_octant(std::uint32_t angle) {
  const std::uint64_t a = angle;
  const std::uint64_t u = (a * a) >> 26;
  const std::uint64_t sine = (a * alternating(kSine, u) + (std::uint64_t{1} << 31)) >> 32;
  const std::uint64_t cosine = (alternating(kCosine, u) + 4) >> 3;
  return {static_cast<std::int32_t>(sine), static_cast<std::int32_t>(cosine)};
}

}  // namespace

SinCos sin_cos_q30(std::uint32_t angle) {
  const std::uint32_t rest = angle % kQuarterTurn;
  SinCos result = sin_cos_of_octant(rest <= kEighthTurn ? rest : kQuarterTurn - rest);
  if (rest > kEighthTurn) std::swap(result.sin, result.cos);
  switch (angle / kQuarterTurn) {
    case 1:
      return {result.cos, -result.sin};
    case 2:
      return {-result.sin, -result.cos};
    case 3:
      return {-result.cos, result.sin};
    default:
      return result;
  }
}

std::int64_t mul_shift_portable(std::int64_t a, std::int64_t b, unsigned shift) {
  // The product of the sizes in two words ...
  const bool negative = (a < 0) != (b < 0);
  const std::uint64_t x = a < 0 ? -static_cast<std::uint64_t>(a) : static_cast<std::uint64_t>(a);
  const std::uint64_t y = b < 0 ? -static_cast<std::uint64_t>(b) : static_cast<std::uint64_t>(b);
  const std::uint64_t x0 = x & 0xffffffff, x1 = x >> 32;
  const std::uint64_t y0 = y & 0xffffffff, y1 = y >> 32;
  const std::uint64_t middle = x1 * y0 + ((x0 * y0) >> 32);
  const std::uint64_t middle2 = x0 * y1 + (middle & 0xffffffff);
  std::uint64_t high = x1 * y1 + (middle >> 32) + (middle2 >> 32);
  std::uint64_t low = (middle2 << 32) | ((x0 * y0) & 0xffffffff);
  // ... and -ceil(size / 2^shift) = floor(-size / 2^shift), through size + 2^shift - 1.
  if (shift > 127) shift = 127;
  if (negative) {
    const std::uint64_t low_ones = shift >= 64 ? UINT64_MAX : (std::uint64_t{1} << shift) - 1;
    const std::uint64_t high_ones = shift > 64 ? (std::uint64_t{1} << (shift - 64)) - 1 : 0;
    low += low_ones;
    high += high_ones + (low < low_ones ? 1 : 0);
  }
  if (shift >= 64) {
    low = high >> (shift - 64);
    high = 0;
  } else if (shift > 0) {
    low = (low >> shift) | (high << (64 - shift));
    high >>= shift;
  }
  const bool large = high != 0 || low > static_cast<std::uint64_t>(kSaturated);
  const std::int64_t size = large ? kSaturated : static_cast<std::int64_t>(low);
  return negative ? -size : size;
}

std::uint64_t isqrt(std::uint64_t n) {
  if (n < 2) return n;
  // Newton's method from above falls until it reaches the floor.
  std::uint64_t root = std::uint64_t{1} << ((std::bit_width(n) + 1) / 2);
  while (true) {
    const std::uint64_t next = (root + n / root) / 2;
    if (next >= root) return root;
    root = next;
  }
}

std::uint32_t angle_from_radians(double radians) {
  constexpr double kUnitsPerRadian = 683565275.57643158978229477;  // 2^31 / pi
  constexpr double kTurn = 4294967296.0;
  if (!std::isfinite(radians)) return 0;
  // fmod is exact, so that the two roundings are those of the product and of llround.
  const double units = std::fmod(radians * kUnitsPerRadian, kTurn);
  return static_cast<std::uint32_t>(std::isfinite(units) ? std::llround(units) : 0);
}

double radians_from_angle(std::int32_t angle) {
  // In integers up to the one rounding of the conversion: x87 registers make no difference.
  constexpr std::int64_t kPiQ61 = 7244019458077122842;
  constexpr double kUnit = 1.0 / (std::int64_t{1} << 59);
  return static_cast<double>(mul_shift(angle, kPiQ61, 33)) * kUnit;
}

}  // namespace curlidar
