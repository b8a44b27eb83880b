// SPDX-License-Identifier: BSD-3-Clause
#include "compact/scan_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/clouds.hpp"

namespace curlidar::compact {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

double radians(std::uint32_t angle) {
  return static_cast<std::int32_t>(angle) / 4294967296.0 * kTurn;
}

TEST(ScanPoints, LieWhereRowAndColumnLook) {
  RowTable table;
  table.turn_columns = 1024;
  table.first_column = 100;
  table.elevation = {1 << 27, 0, -(1 << 28)};
  for (const bool heights : {false, true}) {
    if (heights) table.height = {6554, -6554, 13107};  // .1 m, -.1 m, .2 m
    const PointTable points(table, 3, 50);
    for (std::uint32_t row = 0; row < 3; ++row) {
      for (const std::uint32_t column : {0u, 17u, 49u}) {
        for (const double range : {.7, 12.5, 180.0}) {
          const auto range_q16 = static_cast<std::int32_t>(range * kRangeUnit);
          const double r = range_q16 / 65536.0;
          const double h = heights ? table.height[row] / 65536.0 : 0;
          const double e = radians(static_cast<std::uint32_t>(table.elevation[row])) + h / r;
          const double a = -kTurn / 2 + kTurn * (column + 100) / 1024;
          const Vec3 p = points.metres(row, column, range_q16);
          const double tolerance = r * 5e-9 + 1e-10;
          EXPECT_NEAR(p.x, r * std::cos(e) * std::cos(a), tolerance);
          EXPECT_NEAR(p.y, r * std::cos(e) * std::sin(a), tolerance);
          EXPECT_NEAR(p.z, r * std::sin(e), tolerance);
        }
      }
    }
  }
}

TEST(ScanPoints, AreWholeNumbersOfTheirUnit) {
  test::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const SinCos e = sin_cos_q30(static_cast<std::uint32_t>(random.next()));
    const SinCos a = sin_cos_q30(static_cast<std::uint32_t>(random.next()));
    const auto range = static_cast<std::int32_t>(1 + random.below(1u << 30));
    const FixedPoint p = point_at(range, e, a);
    EXPECT_LE(std::abs(p.x), std::int64_t{1} << 50);
    const Vec3 metres = to_metres(p);
    EXPECT_EQ(std::ldexp(metres.x, 36), static_cast<double>(p.x));
    EXPECT_EQ(static_cast<std::int64_t>(std::ldexp(metres.y, 36)), p.y);
    EXPECT_EQ(static_cast<std::int64_t>(std::ldexp(metres.z, 36)), p.z);
  }
}

TEST(ScanPoints, HeightsAreSeenFromNearAndFar) {
  RowTable table;
  table.turn_columns = 4;
  table.elevation = {0};
  table.height = {-kMaxRowOffset};
  // Far beyond a quarter turn: wraps, and stays defined.
  EXPECT_EQ(elevation_at(table, 0, 1),
            static_cast<std::uint32_t>(-(std::int64_t{kMaxRowOffset} * 683565276)));
  table.height = {1};
  EXPECT_EQ(elevation_at(table, 0, 683565276), 1u);
  EXPECT_EQ(elevation_at(table, 0, 683565277), 0u);
  table.height = {-1};
  EXPECT_EQ(elevation_at(table, 0, 683565277), 0xffffffffu);
}

}  // namespace
}  // namespace curlidar::compact
