// SPDX-License-Identifier: BSD-3-Clause
// Interpolation between raw samples, on cases worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "report/measure/ring_samples.hpp"

namespace curlidar::bench {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t kColumns = 36;
constexpr double kColumn = 2 * std::numbers::pi / kColumns;

/// Two rings, at +0.1 and -0.1 radians, with samples at azimuths 0 and one column further.
RingSamples two_rings(double top_right, double top_left, double bottom_right, double bottom_left) {
  const std::vector<Vec3> points{
      direction_of(0.1, 0) * top_right, direction_of(0.1, kColumn) * top_left,
      direction_of(-0.1, 0) * bottom_right, direction_of(-0.1, kColumn) * bottom_left};
  const std::vector<std::uint16_t> rings{0, 0, 1, 1};
  return {points, rings, {0.1, -0.1}, kColumns};
}

TEST(MixRanges, IsLinearInInverseRange) {
  EXPECT_DOUBLE_EQ(mix_ranges(2, 6, 0.5, Mixing::linear), 3);
  EXPECT_DOUBLE_EQ(mix_ranges(2, 6, 0, Mixing::linear), 2);
  EXPECT_DOUBLE_EQ(mix_ranges(2, 6, 1, Mixing::linear), 6);
}

TEST(MixRanges, TakesTheNearerSampleOverAnEdge) {
  EXPECT_EQ(mix_ranges(2, 6, 0.4, Mixing::edge_aware), 2);
  EXPECT_EQ(mix_ranges(2, 6, 0.6, Mixing::edge_aware), 6);
  EXPECT_EQ(mix_ranges(6, 2, 0.4, Mixing::edge_aware), 6);
  EXPECT_DOUBLE_EQ(mix_ranges(10, 11.9, 0.5, Mixing::edge_aware),
                   mix_ranges(10, 11.9, 0.5, Mixing::linear));
  EXPECT_EQ(mix_ranges(10, 12.1, 0.4, Mixing::edge_aware), 10);
}

TEST(MixRanges, LoneSamplesCountIfTheyAreTheNearerOnes) {
  EXPECT_EQ(mix_ranges(kNan, 6, 0.6, Mixing::linear), 6);
  EXPECT_TRUE(std::isnan(mix_ranges(kNan, 6, 0.4, Mixing::linear)));
  EXPECT_EQ(mix_ranges(2, kNan, 0.4, Mixing::edge_aware), 2);
  EXPECT_TRUE(std::isnan(mix_ranges(2, kNan, 0.6, Mixing::edge_aware)));
  EXPECT_TRUE(std::isnan(mix_ranges(kNan, kNan, 0.5, Mixing::linear)));
}

TEST(RingSamples, MixTheFourSamplesAroundADirection) {
  const RingSamples samples = two_rings(10, 10, 20, 20);
  const double middle = kColumn / 2;
  // A quarter of the way down: 1 / (0.75 / 10 + 0.25 / 20).
  EXPECT_NEAR(samples.range(direction_of(0.05, middle), Mixing::linear), 1 / 0.0875, 1e-9);
  EXPECT_NEAR(samples.range(direction_of(0.05, middle), Mixing::edge_aware), 10, 1e-9);
  EXPECT_NEAR(samples.range(direction_of(-0.05, middle), Mixing::edge_aware), 20, 1e-9);
}

TEST(RingSamples, MixAlongTheRingFirst) {
  const RingSamples samples = two_rings(10, 11, 10, 11);
  const Vec3 direction = direction_of(0, kColumn / 4);
  EXPECT_NEAR(samples.range(direction, Mixing::linear), 1 / (0.75 / 10 + 0.25 / 11), 1e-9);
}

TEST(RingSamples, TellNothingBeyondTheOutermostRings) {
  const RingSamples samples = two_rings(10, 10, 20, 20);
  EXPECT_TRUE(std::isnan(samples.range(direction_of(0.11, 0.01), Mixing::linear)));
  EXPECT_TRUE(std::isnan(samples.range(direction_of(-0.11, 0.01), Mixing::linear)));
}

TEST(RingSamples, TellNothingWhereNoSampleIsNear) {
  const RingSamples samples = two_rings(10, 10, 20, 20);
  EXPECT_FALSE(std::isnan(samples.range(direction_of(0, -1.4 * kColumn), Mixing::linear)));
  EXPECT_TRUE(std::isnan(samples.range(direction_of(0, -1.6 * kColumn), Mixing::linear)));
}

TEST(RingSamples, FindNeighboursOverTheSeam) {
  const double pi = std::numbers::pi;
  const std::vector<Vec3> points{
      direction_of(0.1, pi - kColumn / 2) * 10, direction_of(0.1, -pi + kColumn / 2) * 11,
      direction_of(-0.1, pi - kColumn / 2) * 10, direction_of(-0.1, -pi + kColumn / 2) * 11};
  const std::vector<std::uint16_t> rings{0, 0, 1, 1};
  const RingSamples samples(points, rings, {0.1, -0.1}, kColumns);
  EXPECT_NEAR(samples.range(direction_of(0, pi), Mixing::linear), 1 / (0.5 / 10 + 0.5 / 11), 1e-9);
}

/// Samples of a ring lie at elevations of their own: beams do not all start at the origin.
TEST(RingSamples, TakeTheElevationsOfTheSamplesThemselves) {
  const std::vector<Vec3> points{direction_of(0.3, 0) * 10, direction_of(0.1, 0) * 10.5};
  const std::vector<std::uint16_t> rings{0, 1};
  const RingSamples samples(points, rings, {0.1, -0.1}, kColumns);
  EXPECT_NEAR(samples.range(direction_of(0.2, 0), Mixing::linear), 1 / (0.5 / 10 + 0.5 / 10.5),
              1e-9);
}

}  // namespace
}  // namespace curlidar::bench
