// SPDX-License-Identifier: BSD-3-Clause
// Jumps between neighbouring cells: ways between these, and ranges worked out by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "report/measure/jumps.hpp"

namespace curlidar::bench {
namespace {

/// The ground seen further and further away.
WayRanges ground() {
  WayRanges ranges_m;
  for (std::size_t i = 0; i < kStops; ++i) {
    ranges_m[i] = 1 / (0.05 - 0.001 * static_cast<double>(i));
  }
  return ranges_m;
}

/// Three rings in a round room whose cells look beside their columns, as those of rays do: each row
/// further than the one above it. Its beams start on the axis, and the scan moved.
class TurnedRings final : public Field {
 public:
  static constexpr std::uint32_t kColumns = 64;
  explicit TurnedRings(double columns_beside) {
    for (std::uint32_t row = 0; row < 3; ++row) {
      for (std::uint32_t column = 0; column < kColumns; ++column) {
        const double azimuth = lattice_.azimuth(column + row * columns_beside);
        points_.push_back(direction_of(lattice_.elevation(row), azimuth) * 8 + Vec3{0, 0, kUp_m});
      }
    }
  }

  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double, std::span<const double>, bool, std::span<double>) const override {}
  bool occupied(std::uint32_t, std::uint32_t) const override { return true; }
  std::vector<Vec3> cell_points() const override { return points_; }
  RowLine row_line(double row) const override { return {lattice_.elevation(row), kUp_m, false}; }
  bool moves() const override { return true; }
  RigidMotion motion_at(double azimuth) const override { return {.move = {azimuth, 2, 0}}; }
  void range_along(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                   std::size_t) const override {
    for (std::size_t i = 0; i < lines.size(); ++i) estimates[i] = {8, 1, Seen::surface};
    estimates.back().seen = Seen::nothing;
  }
  void clear(std::size_t cell) { points_[cell].x = std::numeric_limits<double>::quiet_NaN(); }

 private:
  static constexpr double kUp_m = .2;
  Lattice lattice_ = Lattice::from_rings({.1, 0, -.1}, kColumns);
  std::vector<Vec3> points_;
};

double away_from(const Sightline& line, const Vec3& point) {
  return norm(cross(line.direction, point - line.origin));
}

TEST(Cells, WaysLeadFromOneReturnToTheOther) {
  const Cells cells(std::make_shared<TurnedRings>(.7));
  std::size_t along = 0, down = 0;
  for (const CellPair& pair : cells.pairs(std::vector<std::uint32_t>(192, 0), 1000)) {
    const Way way = cells.way(pair);
    EXPECT_LT(away_from(way.front(), cells.coded(pair.from)), 1e-9);
    EXPECT_LT(away_from(way.back(), cells.coded(pair.to)), 1e-9);
    const double whole = norm(way.back().direction - way.front().direction);
    EXPECT_LT(whole, 1.5 * .1);
    for (std::size_t i = 1; i < kStops; ++i) {
      EXPECT_NEAR(norm(way[i].direction - way[i - 1].direction), whole / (kStops - 1), 1e-4);
    }
    ++(pair.to == pair.from + 1 ? along : down);
  }
  EXPECT_EQ(along, 3 * 63u);
  EXPECT_EQ(down, 2 * 64u);
}

TEST(Cells, ThatLookElsewhereAreNoPairs) {
  const Cells cells(std::make_shared<TurnedRings>(2));
  for (const CellPair& pair : cells.pairs(std::vector<std::uint32_t>(192, 0), 1000)) {
    EXPECT_EQ(pair.to, pair.from + 1);
  }
}

TEST(Cells, PairsAreOnBordersWhereBlocksDifferAndHoldReturns) {
  const auto field = std::make_shared<TurnedRings>(0);
  field->clear(10);
  std::vector<std::uint32_t> block(192, 0);
  for (std::size_t cell = 0; cell < block.size(); ++cell) block[cell] = cell % 64 < 32 ? 1 : 2;
  std::size_t borders = 0;
  for (const CellPair& pair : Cells(field).pairs(block, 1000)) {
    EXPECT_TRUE(pair.from != 10 && pair.to != 10);
    EXPECT_EQ(pair.border, pair.from % 64 == 31 && pair.to == pair.from + 1);
    borders += pair.border ? 1 : 0;
  }
  EXPECT_EQ(borders, 3u);
  EXPECT_EQ(Cells(field).pairs(block, 2).size(), 4u);
}

TEST(Cells, AroundAWayAreThoseBetweenWhichItPasses) {
  const Cells cells(std::make_shared<TurnedRings>(.7));
  using Numbers = std::vector<std::size_t>;
  const auto around = [&](const CellPair& pair) {
    Numbers numbers = cells.around(pair);
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
  };
  EXPECT_EQ(around({20, 21, false}), (Numbers{20, 21}));
  // From column 20 to column 20.7: the lower row's are 19.7, 20.7 and 21.7.
  EXPECT_EQ(around({20, 84, false}), (Numbers{19, 20, 21, 83, 84, 85}));
  EXPECT_EQ(around({64, 128, false}), (Numbers{64, 65, 127, 128, 129, 191}));  // around the turn
}

TEST(RangesAlong, AreUnknownWhereNothingIsBelieved) {
  const auto field = std::make_shared<TurnedRings>(0);
  const WayRanges ranges_m = ranges_along(*field, Cells(field).way({0, 1, false}));
  EXPECT_EQ(ranges_m.front(), 8);
  EXPECT_TRUE(std::isnan(ranges_m.back()));
}

TEST(JumpOf, IsNoneOnAPlane) {
  EXPECT_NEAR(jump_of(ground()), 0, 1e-9);
}

TEST(JumpOf, IsTheStepWhereThereIsOne) {
  WayRanges ranges_m;
  for (std::size_t i = 0; i < kStops; ++i) ranges_m[i] = i < 9 ? 10 : 10.5;
  EXPECT_NEAR(jump_of(ranges_m), 0.5, 1e-9);
  ranges_m[16] = 10;  // and back
  EXPECT_NEAR(jump_of(ranges_m), 0.5 * 16 / 15, 1e-9);
}

TEST(JumpOf, IsUnknownWhereNothingIsTold) {
  WayRanges ranges_m = ground();
  ranges_m[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(jump_of(ranges_m)));
}

}  // namespace
}  // namespace curlidar::bench
