// SPDX-License-Identifier: BSD-3-Clause
#include "fixed/fixed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace curlidar {
namespace {

constexpr std::uint32_t kQuarter = std::uint32_t{1} << 30;
constexpr double kPi = std::numbers::pi;

std::uint64_t next_random(std::uint64_t& state) {
  state = state * 6364136223846793005u + 1442695040888963407u;
  return state ^ (state >> 29);
}

/// Numbers around all powers of two, both signs, and some in between.
std::vector<std::int64_t> edge_values() {
  std::vector<std::int64_t> values{0};
  std::uint64_t state = 1;
  for (int bit = 0; bit < 64; ++bit) {
    const std::uint64_t power = std::uint64_t{1} << bit;
    for (const std::uint64_t value :
         {power - 1, power, power + 1, next_random(state) >> (63 - bit)}) {
      values.push_back(static_cast<std::int64_t>(value));
      values.push_back(static_cast<std::int64_t>(std::uint64_t{0} - value));
    }
  }
  return values;
}

TEST(SinCos, IsWithinAUnitOfTheTruth) {
  double largest = 0.0;
  constexpr std::uint32_t kStep = 4099;  // a prime: a million angles without a pattern
  for (std::uint64_t angle = 0; angle < std::uint64_t{1} << 32; angle += kStep) {
    const SinCos found = sin_cos_q30(static_cast<std::uint32_t>(angle));
    const double radians = static_cast<double>(angle) * (kPi / 2147483648.0);
    largest = std::max({largest, std::abs(found.sin - std::sin(radians) * kOneQ30),
                        std::abs(found.cos - std::cos(radians) * kOneQ30)});
  }
  EXPECT_LT(largest, 1.0);
  EXPECT_GT(largest, 0.4);  // rounding alone gives half a unit
}

TEST(SinCos, IsExactAtTheQuadrants) {
  EXPECT_EQ(sin_cos_q30(0), (SinCos{0, kOneQ30}));
  EXPECT_EQ(sin_cos_q30(kQuarter), (SinCos{kOneQ30, 0}));
  EXPECT_EQ(sin_cos_q30(2 * kQuarter), (SinCos{0, -kOneQ30}));
  EXPECT_EQ(sin_cos_q30(3 * kQuarter), (SinCos{-kOneQ30, 0}));
  EXPECT_EQ(sin_cos_q30(kQuarter / 2), (SinCos{759250125, 759250125}));
}

TEST(SinCos, HasTheSymmetriesOfTheCircle) {
  std::uint64_t state = 2;
  for (int i = 0; i < 20000; ++i) {
    const auto angle = static_cast<std::uint32_t>(next_random(state));
    const SinCos here = sin_cos_q30(angle);
    EXPECT_EQ(sin_cos_q30(-angle), (SinCos{-here.sin, here.cos})) << angle;
    EXPECT_EQ(sin_cos_q30(kQuarter - angle), (SinCos{here.cos, here.sin})) << angle;
    EXPECT_EQ(sin_cos_q30(angle + kQuarter), (SinCos{here.cos, -here.sin})) << angle;
  }
}

TEST(SinCos, DoesNotFallWhereTheSineRises) {
  std::uint64_t state = 3;
  for (int i = 0; i < 2000; ++i) {
    const auto start = static_cast<std::uint32_t>(next_random(state) % (kQuarter - 64));
    for (std::uint32_t angle = start; angle < start + 64; ++angle) {
      EXPECT_GE(sin_cos_q30(angle + 1).sin, sin_cos_q30(angle).sin) << angle;
    }
  }
}

// The same on every machine; tests/cross compares longer sweeps.
TEST(SinCos, GivesTheValuesOfTheSpecification) {
  EXPECT_EQ(sin_cos_q30(1), (SinCos{2, 1073741824}));
  EXPECT_EQ(sin_cos_q30(123456789), (SinCos{192872915, 1056277210}));
  EXPECT_EQ(sin_cos_q30(3000000000u), (SinCos{-1017999357, -341465686}));
}

TEST(Isqrt, IsTheFloorOfTheRoot) {
  for (std::uint64_t n = 0, root = 0; n < 100000; ++n) {
    if ((root + 1) * (root + 1) == n) ++root;
    ASSERT_EQ(isqrt(n), root) << n;
  }
  std::uint64_t state = 4;
  for (int i = 0; i < 100000; ++i) {
    const std::uint64_t n = next_random(state) >> (i % 64);
    const std::uint64_t root = isqrt(n);
    ASSERT_LT(root, std::uint64_t{1} << 32);
    ASSERT_LE(root * root, n);
    ASSERT_LE(n - root * root, 2 * root) << n;
  }
}

TEST(Isqrt, IsRightNextToSquares) {
  for (std::uint64_t root = 1; root < std::uint64_t{1} << 32; root = root * 5 / 4 + 1) {
    ASSERT_EQ(isqrt(root * root), root);
    ASSERT_EQ(isqrt(root * root - 1), root - 1);
    ASSERT_EQ(isqrt(root * root + 2 * root), root);
  }
  EXPECT_EQ(isqrt(UINT64_MAX), UINT32_MAX);
  EXPECT_EQ(isqrt(std::uint64_t{UINT32_MAX} * UINT32_MAX), UINT32_MAX);
}

TEST(MulShift, KnownResults) {
  EXPECT_EQ(mul_shift(7, 3, 1), 10);
  EXPECT_EQ(mul_shift(-7, 3, 1), -11);
  EXPECT_EQ(mul_shift(-1, 1, 200), -1);
  EXPECT_EQ(mul_shift(1, 1, 200), 0);
  EXPECT_EQ(mul_shift(INT64_MIN, INT64_MIN, 127), 0);
  EXPECT_EQ(mul_shift(INT64_MIN, INT64_MIN, 126), 1);
  EXPECT_EQ(mul_shift(INT64_MIN, INT64_MAX, 126), -1);
  EXPECT_EQ(mul_shift(INT64_MIN, INT64_MIN, 64), kSaturated);
  EXPECT_EQ(mul_shift(INT64_MIN, INT64_MIN, 63), kSaturated);
  EXPECT_EQ(mul_shift(INT64_MIN, INT64_MAX, 0), -kSaturated);
  EXPECT_EQ(mul_shift(std::int64_t{1} << 40, std::int64_t{3} << 40, 20), std::int64_t{3} << 60);
}

TEST(MulShift, BothPathsAgree) {
  const auto values = edge_values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = 0; j < values.size(); j += 3) {
      const unsigned first = static_cast<unsigned>(i + j) % 7;
      for (unsigned shift = first; shift < 135; shift += 7) {
        ASSERT_EQ(mul_shift(values[i], values[j], shift),
                  mul_shift_portable(values[i], values[j], shift))
            << values[i] << " * " << values[j] << " >> " << shift;
      }
    }
  }
}

TEST(Division, RoundsDownOrToTheNearest) {
  for (std::int64_t a = -60; a <= 60; ++a) {
    for (std::int64_t b = -13; b <= 13; ++b) {
      if (b == 0) continue;
      const double quotient = static_cast<double>(a) / static_cast<double>(b);
      EXPECT_EQ(div_floor(a, b), std::floor(quotient)) << a << " / " << b;
      const double doubled = static_cast<double>(2 * a + b) / static_cast<double>(2 * b);
      EXPECT_EQ(div_round(a, b), std::floor(doubled)) << a << " / " << b;
    }
  }
}

TEST(Division, IsDefinedForAllArguments) {
  EXPECT_EQ(div_floor(5, 0), 0);
  EXPECT_EQ(div_round(5, 0), 0);
  EXPECT_EQ(div_floor(INT64_MIN, -1), INT64_MAX);
  EXPECT_EQ(div_round(INT64_MIN, -1), INT64_MAX);
  EXPECT_EQ(div_round(INT64_MAX, INT64_MAX - 1), 1);
  EXPECT_EQ(div_round(INT64_MIN, INT64_MAX), -1);
  EXPECT_EQ(div_floor(INT64_MIN, INT64_MAX), -2);
  EXPECT_EQ(div_round(INT64_MAX, INT64_MIN), -1);
  for (const std::int64_t a : edge_values()) {
    for (const std::int64_t b : edge_values()) {
      if (b == 0 || b == -1) continue;
      const std::int64_t quotient = div_floor(a, b);
      const auto remainder = static_cast<std::int64_t>(static_cast<std::uint64_t>(a) -
                                                       static_cast<std::uint64_t>(quotient) *
                                                           static_cast<std::uint64_t>(b));
      EXPECT_TRUE(b > 0 ? remainder >= 0 && remainder < b : remainder <= 0 && remainder > b)
          << a << " / " << b;
      EXPECT_LE(static_cast<std::uint64_t>(div_round(a, b) - quotient), 1u) << a << " / " << b;
    }
  }
}

TEST(ShiftRightRound, RoundsHalvesUp) {
  EXPECT_EQ(shift_right_round(5, 0), 5);
  EXPECT_EQ(shift_right_round(5, 1), 3);
  EXPECT_EQ(shift_right_round(-5, 1), -2);
  EXPECT_EQ(shift_right_round(-6, 2), -1);
  EXPECT_EQ(shift_right_round(-7, 2), -2);
  EXPECT_EQ(shift_right_round(INT64_MAX, 1), std::int64_t{1} << 62);
  EXPECT_EQ(shift_right_round(INT64_MAX, 63), 1);
  EXPECT_EQ(shift_right_round(INT64_MIN, 63), -1);
  EXPECT_EQ(shift_right_round(INT64_MIN, 64), 0);
  EXPECT_EQ(shift_right_round(INT64_MAX, 64), 0);
  for (std::int64_t x = -100; x <= 100; ++x) {
    for (unsigned n = 1; n < 10; ++n) {
      EXPECT_EQ(shift_right_round(x, n), (x + (std::int64_t{1} << (n - 1))) >> n);
    }
  }
}

TEST(Angles, ConvertFromRadians) {
  EXPECT_EQ(angle_from_radians(0.0), 0u);
  EXPECT_EQ(angle_from_radians(kPi / 2), kQuarter);
  EXPECT_EQ(angle_from_radians(-kPi / 2), 3 * kQuarter);
  EXPECT_EQ(angle_from_radians(kPi), 2 * kQuarter);
  EXPECT_EQ(angle_from_radians(-kPi), 2 * kQuarter);
  EXPECT_EQ(angle_from_radians(5 * kPi / 2), kQuarter);
  EXPECT_EQ(angle_from_radians(-1e-12), 0u);
  EXPECT_EQ(angle_from_radians(2 * kPi - 1e-12), 0u);
  for (const double bad :
       {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN(), 1e308}) {
    EXPECT_EQ(angle_from_radians(bad), 0u);
  }
}

TEST(Angles, ComeBackFromRadians) {
  EXPECT_EQ(radians_from_angle(0), 0.0);
  EXPECT_EQ(radians_from_angle(INT32_MIN), -kPi);
  EXPECT_EQ(radians_from_angle(std::int32_t{1} << 30), kPi / 2);
  std::uint64_t state = 5;
  for (int i = 0; i < 20000; ++i) {
    const auto angle = static_cast<std::int32_t>(next_random(state));
    EXPECT_NEAR(radians_from_angle(angle), angle * (kPi / 2147483648.0), 1e-15);
    EXPECT_EQ(static_cast<std::int32_t>(angle_from_radians(radians_from_angle(angle))), angle);
  }
}

}  // namespace
}  // namespace curlidar
