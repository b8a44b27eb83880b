// SPDX-License-Identifier: BSD-3-Clause
// Jumps between neighbouring cells, on ways worked out by hand.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "report/measure/jumps.hpp"

namespace curlidar::bench {
namespace {

/// The ground seen further and further away.
std::array<double, kStops> ground() {
  std::array<double, kStops> ranges_m;
  for (std::size_t i = 0; i < kStops; ++i) {
    ranges_m[i] = 1 / (0.05 - 0.001 * static_cast<double>(i));
  }
  return ranges_m;
}

TEST(JumpOf, IsNoneOnAPlane) {
  EXPECT_NEAR(jump_of(ground()), 0, 1e-9);
}

TEST(JumpOf, IsTheStepWhereThereIsOne) {
  std::array<double, kStops> ranges_m;
  for (std::size_t i = 0; i < kStops; ++i) ranges_m[i] = i < 9 ? 10 : 10.5;
  EXPECT_NEAR(jump_of(ranges_m), 0.5, 1e-9);
  ranges_m[16] = 10;  // and back
  EXPECT_NEAR(jump_of(ranges_m), 0.5 * 16 / 15, 1e-9);
}

TEST(JumpOf, IsUnknownWhereNothingIsTold) {
  std::array<double, kStops> ranges_m = ground();
  ranges_m[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(jump_of(ranges_m)));
}

}  // namespace
}  // namespace curlidar::bench
