// SPDX-License-Identifier: BSD-3-Clause
// Exact integer mathematics of the compact profile. Every result is a matter of definition, not of
// the machine: no floating point where decoder and encoder must agree, no undefined behaviour for
// any argument.
//
// A *binary angle* counts 2^32 to a turn and wraps; as std::int32_t it is an angle in [-pi, pi).
// Qn means units of 2^-n.
#pragma once

#include <cstdint>

namespace curlidar {

inline constexpr std::int32_t kOneQ30 = std::int32_t{1} << 30;
/// Where mul_shift stops on either side.
inline constexpr std::int64_t kSaturated = std::int64_t{1} << 62;

/// floor(x / 2^n + 1/2): the nearest integer, halves towards +infinity; 0 for n > 63.
constexpr std::int64_t shift_right_round(std::int64_t x, unsigned n) {
  if (n == 0) return x;
  if (n > 63) return 0;
  return (x >> n) + ((x >> (n - 1)) & 1);
}

/// floor(a / b). a / 0 is 0; the one quotient that does not fit, -2^63 / -1, is 2^63 - 1.
constexpr std::int64_t div_floor(std::int64_t a, std::int64_t b) {
  if (b == 0) return 0;
  if (b == -1) return a == INT64_MIN ? INT64_MAX : -a;
  const std::int64_t quotient = a / b;
  return a % b != 0 && (a < 0) != (b < 0) ? quotient - 1 : quotient;
}

/// floor(a / b + 1/2): the nearest integer, halves towards +infinity. Special cases as div_floor.
constexpr std::int64_t div_round(std::int64_t a, std::int64_t b) {
  const std::int64_t quotient = div_floor(a, b);
  if (b == 0 || b == -1) return quotient;
  // Modulo 2^64: the product may leave 64 bits, the remainder does not. It has the sign of b.
  const auto remainder = static_cast<std::int64_t>(static_cast<std::uint64_t>(a) -
                                                   static_cast<std::uint64_t>(quotient) *
                                                       static_cast<std::uint64_t>(b));
  const bool up = b > 0 ? remainder >= b - remainder : remainder <= b - remainder;
  return up ? quotient + 1 : quotient;
}

/// mul_shift in 32-bit pieces, for machines without a 128-bit integer; tests compare the two.
std::int64_t mul_shift_portable(std::int64_t a, std::int64_t b, unsigned shift);

/// floor(a b / 2^shift), exactly, then limited to [-2^62, 2^62]. A shift above 127 acts as 127.
inline std::int64_t mul_shift(std::int64_t a, std::int64_t b, unsigned shift) {
#ifdef __SIZEOF_INT128__
  __extension__ using Int128 = __int128;
  const Int128 result = (static_cast<Int128>(a) * b) >> (shift < 127 ? shift : 127);
  if (result > kSaturated) return kSaturated;
  if (result < -kSaturated) return -kSaturated;
  return static_cast<std::int64_t>(result);
#else
  return mul_shift_portable(a, b, shift);
#endif
}

/// floor(sqrt(n)), exactly. A few divisions.
std::uint64_t isqrt(std::uint64_t n);

struct SinCos {
  std::int32_t sin = 0;
  std::int32_t cos = 0;

  friend bool operator==(const SinCos&, const SinCos&) = default;
};

/// Sine and cosine in Q30 of a binary angle, as the format defines them: within one unit of the
/// true values, monotone in every quadrant, exact at multiples of a quarter turn, with all
/// symmetries of the octants.
///
/// Definition (all divisions round down; a is an integer):
///   q = floor(angle / 2^30), r = angle mod 2^30; a = r if r <= 2^29, otherwise 2^30 - r.
///   u = floor(a^2 / 2^26).
///   With C_k = round(2^33 (pi/4)^k / k!), from the highest term down, h = C_k - floor(u h / 2^32):
///     cosine: k = 10, 8, .. 0, cos = floor((h + 4) / 8);
///     sine:   k = 11, 9, .. 1,  sin = floor((a h + 2^31) / 2^32).
///   If r > 2^29 swap them; then turn by q quarter turns: (sin, cos) -> (cos, -sin) each.
SinCos sin_cos_q30(std::uint32_t angle);

/// The binary angle next to an angle in radians, of any number of turns; 0 if it is not finite.
/// For encoders: the only function here that takes floating point.
std::uint32_t angle_from_radians(double radians);

/// The angle in radians, in [-pi, pi), for public interfaces. The same double on every machine.
double radians_from_angle(std::int32_t angle);

}  // namespace curlidar
