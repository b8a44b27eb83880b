// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curlidar::scenery {
namespace {

TEST(Random, SameSeedSameSequenceOtherSeedOther) {
  Random a(1), b(1), c(2), d(1, 1);
  int same_as_c = 0, same_as_d = 0;
  for (int i = 0; i < 100; ++i) {
    const double value = a.uniform(0, 1);
    EXPECT_EQ(value, b.uniform(0, 1));
    same_as_c += value == c.uniform(0, 1);
    same_as_d += value == d.uniform(0, 1);
  }
  EXPECT_EQ(same_as_c, 0);
  EXPECT_EQ(same_as_d, 0);
}

TEST(Random, ScrambleIsSplitMix64) {
  // First output of SplitMix64 seeded with 0: its finaliser on the golden ratio's increment.
  EXPECT_EQ(scramble(0x9e3779b97f4a7c15u), 0xe220a8397b1dcdafu);
}

TEST(Random, UniformStaysInsideAndIsFlat) {
  Random random(4);
  int bins[10] = {};
  for (int i = 0; i < 20000; ++i) {
    const double value = random.uniform(-2, 3);
    ASSERT_GE(value, -2);
    ASSERT_LT(value, 3);
    ++bins[static_cast<int>((value + 2) * 2)];
  }
  for (const int count : bins) EXPECT_NEAR(count, 2000, 200);
}

TEST(Random, BelowGivesEveryNumber) {
  Random random(4);
  int seen = 0;
  for (int i = 0; i < 200; ++i) {
    const int value = random.below(5);
    ASSERT_GE(value, 0);
    ASSERT_LT(value, 5);
    seen |= 1 << value;
  }
  EXPECT_EQ(seen, 31);
}

TEST(Random, GaussianHasMomentsOfTheNormalDistribution) {
  constexpr int kDraws = 40000;
  double sum = 0, sum2 = 0, sum4 = 0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double g = gaussian(keyed_bits(1, i, 0, 0), keyed_bits(1, i, 0, 1));
    ASSERT_TRUE(std::isfinite(g));
    sum += g;
    sum2 += g * g;
    sum4 += g * g * g * g;
  }
  EXPECT_NEAR(sum / kDraws, 0, 0.02);
  EXPECT_NEAR(sum2 / kDraws, 1, 0.03);
  EXPECT_NEAR(sum4 / kDraws, 3, 0.25);
}

TEST(Random, GaussianIsFiniteAtTheEnds) {
  EXPECT_TRUE(std::isfinite(gaussian(0, 0)));
  EXPECT_TRUE(std::isfinite(gaussian(~std::uint64_t{0}, ~std::uint64_t{0})));
}

}  // namespace
}  // namespace curlidar::scenery
