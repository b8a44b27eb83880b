// SPDX-License-Identifier: BSD-3-Clause
// Between the samples of worlds that are known.
#include "dense/dense_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "codec/compact_field.hpp"
#include "unit/dense/ring_field.hpp"

namespace curlidar {
namespace {

using test::RingField;
using test::TestRing;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Rings from 10 degrees up to 22 degrees down; beams start beside the axis if asked for.
std::vector<TestRing> rings(bool origins) {
  std::vector<TestRing> rings;
  for (int k = 0; k < 16; ++k) {
    TestRing ring{(10 - 2.1 * k) * kDegree, 0, 0};
    if (origins) ring = {ring.elevation, k < 8 ? .21 : .13, k % 2 == 0 ? .026 : -.026};
    rings.push_back(ring);
  }
  return rings;
}

RangeEstimate estimate(const Field& field, const Sightline& line) {
  RangeEstimate estimate;
  field.range_along(std::span(&line, 1), std::span(&estimate, 1));
  return estimate;
}

struct PlaneCase {
  Vec3 normal;
  double distance_m;
  bool origins;
};

class DensePlane : public ::testing::TestWithParam<PlaneCase> {};

TEST_P(DensePlane, IsExactBetweenTheRingsWhereverLinesStart) {
  const PlaneCase& c = GetParam();
  const test::World world = test::plane(c.normal, c.distance_m);
  const auto field = dense_field(std::make_shared<RingField>(rings(c.origins), 720, world));
  std::size_t seen = 0;
  for (const Vec3& origin : {Vec3{}, Vec3{0, 0, .3}, Vec3{.2, -.1, .1}}) {
    for (double up = -21; up <= 9; up += .37) {
      for (double around = -179.9; around < 180; around += 7.3) {
        const Vec3 direction = direction_of(up * kDegree, around * kDegree);
        const double truth = world(origin, direction);
        const RangeEstimate told = estimate(*field, {origin, direction});
        if (!told.valid() || !(truth < 60)) continue;
        ASSERT_NEAR(told.range_m, truth, 1e-6 * truth) << up << ' ' << around;
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 1000u);
}

INSTANTIATE_TEST_SUITE_P(Planes, DensePlane,
                         ::testing::Values(PlaneCase{{0, 0, 1}, -1.7, false},
                                           PlaneCase{{0, 0, 1}, -1.7, true},
                                           PlaneCase{{1, 0, 0}, 8, true},
                                           PlaneCase{{-.8, .6, 0}, 15, true},
                                           PlaneCase{{-.7, 0.2, .6}, 12, true}));

TEST(DenseField, SaysNothingOfLinesThatAreNone) {
  const auto field =
      dense_field(std::make_shared<RingField>(rings(false), 360, test::plane({1, 0, 0}, 8)));
  for (const Sightline& line :
       {Sightline{{}, {}}, Sightline{{}, {kNan, 0, 0}}, Sightline{{kNan, 0, 0}, {1, 0, 0}},
        Sightline{{}, {std::numeric_limits<double>::infinity(), 0, 0}}}) {
    const RangeEstimate told = estimate(*field, line);
    EXPECT_EQ(told.seen, Seen::unknown);
    EXPECT_TRUE(std::isnan(told.range_m));
    EXPECT_EQ(told.confidence, 0);
  }
}

TEST(DenseField, OfNothingKnowsNothing) {
  const auto field = dense_field(std::make_shared<EmptyField>());
  EXPECT_EQ(estimate(*field, {{}, {1, 0, 0}}).seen, Seen::unknown);
  EXPECT_EQ(field->sources_at({1, 2, 3}).weight, (std::array<double, 4>{}));
}

TEST(DenseField, MasksLeaveTheFieldAlone) {
  const auto plain = std::make_shared<EmptyField>();
  EXPECT_EQ(dense_field(plain, {.strategy = DenseStrategy::masks}), plain);
}

/// A box around the sensor that is open above 5 degrees, with a pillar at azimuth 0.
double street(const Vec3& origin, const Vec3& direction) {
  constexpr double kPillarX = 4, kPillarHalf = 0.4, kGround = -1.7, kWall = 12;
  const auto inside = [&](double length) { return length > 0 ? length : 1e9; };
  double length = inside((kGround - origin.z) / direction.z);
  length = std::min(length, inside((std::copysign(kWall, direction.x) - origin.x) / direction.x));
  length = std::min(length, inside((std::copysign(kWall, direction.y) - origin.y) / direction.y));
  const double pillar = inside((kPillarX - origin.x) / direction.x);
  if (std::abs(origin.y + pillar * direction.y) < kPillarHalf) length = std::min(length, pillar);
  const bool sky = direction.z > std::sin(5 * kDegree);
  return sky ? kNan : length;
}

std::shared_ptr<const Field> street_field(bool origins = true) {
  return dense_field(std::make_shared<RingField>(rings(origins), 720, street));
}

TEST(DenseField, LeavesCliffsSharp) {
  const auto field = street_field();
  std::size_t near = 0, far = 0;
  for (double around = -9; around <= 9; around += .05) {
    for (double up = -3; up <= 4; up += .13) {
      const Vec3 direction = direction_of(up * kDegree, around * kDegree);
      const RangeEstimate told = estimate(*field, {{}, direction});
      ASSERT_TRUE(told.valid()) << up << ' ' << around;
      // On the pillar or on the wall behind it, nowhere between.
      const double x = told.range_m * direction.x;
      const bool pillar = std::abs(x - 4) < .05, wall = std::abs(x - 12) < .05;
      ASSERT_TRUE(pillar || wall) << x << " at " << up << ' ' << around;
      ++(pillar ? near : far);
      const double edge = std::atan2(.4, 4) / kDegree;  // known to a column
      if (std::abs(around) < edge - .5) {
        EXPECT_TRUE(pillar);
      }
      if (std::abs(around) > edge + .5) {
        EXPECT_TRUE(wall);
      }
    }
  }
  EXPECT_GT(near, 1000u);
  EXPECT_GT(far, 1000u);
}

TEST(DenseField, FollowsTheGroundUpToWhatStandsOnIt) {
  const auto field = street_field(false);
  double worst = 0;
  for (double up = -20; up <= -4; up += .11) {
    for (double around = 20; around <= 70; around += 1.7) {
      const Vec3 direction = direction_of(up * kDegree, around * kDegree);
      const RangeEstimate told = estimate(*field, {{}, direction});
      ASSERT_TRUE(told.valid());
      worst = std::max(worst, std::abs(told.range_m - street({}, direction)));
    }
  }
  EXPECT_LT(worst, .35);  // chords over the foot of the wall are 1 m off
}

TEST(DenseField, InventsNothingInTheSky) {
  const auto field = street_field();
  for (double around = -180; around < 180; around += 3.3) {
    const RangeEstimate told = estimate(*field, {{}, direction_of(8 * kDegree, around * kDegree)});
    EXPECT_EQ(told.seen, Seen::nothing) << around;
    EXPECT_LT(told.confidence, .5);
  }
}

TEST(DenseField, LeavesGapsEmptyAndFillsHoles) {
  auto plain = std::make_shared<RingField>(rings(true), 720, test::plane({0, 1, 0}, 8));
  for (std::uint32_t row = 0; row < 16; ++row) {
    for (std::uint32_t column = 530; column < 560; ++column) plain->clear(row, column);
    plain->clear(row, 500 + row);  // one hole in each ring
  }
  const auto field = dense_field(plain);
  const auto seen = [&](double column) {
    const double azimuth = plain->lattice().azimuth(column);
    return estimate(*field, {{}, direction_of(-3.3 * kDegree, azimuth)}).seen;
  };
  // No laser fired there at all: nobody knows.
  for (double column = 534; column < 556; column += .4) EXPECT_EQ(seen(column), Seen::unknown);
  for (double column = 490; column < 528; column += .4) EXPECT_EQ(seen(column), Seen::surface);
}

TEST(DenseField, KnowsAGapThatOtherRingsSawBeyond) {
  auto plain = std::make_shared<RingField>(rings(false), 720, test::plane({0, 1, 0}, 8));
  for (std::uint32_t row = 4; row < 9; ++row) {
    for (std::uint32_t column = 530; column < 560; ++column) plain->clear(row, column);
  }
  const auto field = dense_field(plain);
  const double azimuth = plain->lattice().azimuth(545.3);
  const double up = plain->lattice().elevation(6.4);
  EXPECT_EQ(estimate(*field, {{}, direction_of(up, azimuth)}).seen, Seen::nothing);
}

TEST(DenseField, EndsHalfAStepBeyondTheOutermostRings) {
  const test::World world = test::plane({-.8, .6, 0}, 15);
  const auto plain = std::make_shared<RingField>(rings(false), 720, world);
  const auto field = dense_field(plain);
  const double azimuth = 143.2 * kDegree;
  for (const auto& [row, seen] : {std::pair{-.45, Seen::surface},
                                  {-.6, Seen::unknown},
                                  {-20.0, Seen::unknown},
                                  {15.45, Seen::surface},
                                  {15.6, Seen::unknown},
                                  {40.0, Seen::unknown}}) {
    const Vec3 direction = direction_of(plain->lattice().elevation(row), azimuth);
    const RangeEstimate told = estimate(*field, {{}, direction});
    EXPECT_EQ(told.seen, seen) << row;
    if (told.valid()) {
      EXPECT_NEAR(told.range_m, world({}, direction), 1e-6) << row;
    }
  }
  EXPECT_FALSE(estimate(*field, {{}, {0, 0, 1}}).valid());
  EXPECT_FALSE(estimate(*field, {{}, {0, 0, -1}}).valid());
}

TEST(DenseField, IsOneSurfaceAcrossTheSeam) {
  const auto field =
      dense_field(std::make_shared<RingField>(rings(true), 720, test::plane({-1, 0, 0}, 8)));
  for (double beside = -.7; beside <= .7; beside += .01) {
    const Vec3 direction = direction_of(-5 * kDegree, (180 + beside) * kDegree);
    const RangeEstimate told = estimate(*field, {{}, direction});
    ASSERT_TRUE(told.valid()) << beside;
    EXPECT_NEAR(told.range_m * direction.x, -8, 1e-6) << beside;
  }
}

TEST(DenseField, SaysOfItsCellsWhatTheirBeamsSaw) {
  const auto plain = std::make_shared<RingField>(rings(true), 360, street, .07);
  const auto field = dense_field(plain);
  std::size_t cells = 0;
  for (std::uint32_t row = 0; row < 16; ++row) {
    for (std::uint32_t column = 0; column < 360; ++column) {
      const Vec3& p = plain->point(row, column);
      if (std::isnan(p.x)) continue;
      const double at = plain->lattice().column_of(azimuth_of(p));
      double told = 0;
      field->evaluate_row(row, std::span(&at, 1), true, std::span(&told, 1));
      const double coded = plain->row_line(row).range_of(std::hypot(p.x, p.y), p.z);
      EXPECT_NEAR(told, coded, 1e-3 * coded) << row << ' ' << column;
      ++cells;
    }
  }
  EXPECT_GT(cells, 3000u);
}

TEST(DenseField, LeavesOutWhatItsRingsMeasureTooFar) {
  const auto wall =
      dense_field(std::make_shared<RingField>(rings(false), 720, test::plane({0, 1, 0}, 8), .07));
  const std::array columns{520.0, 540.0, 540.5};
  for (const double row : {4.8, 5.0, 5.5}) {
    for (const bool masked : {true, false}) {
      std::array<double, 3> ranges{};
      std::array<Vec3, 3> points;
      wall->evaluate_row(row, columns, masked, ranges);
      wall->place_row(row, columns, ranges, points);
      for (const Vec3& p : points) EXPECT_NEAR(p.y, 8, 1e-6) << row;
    }
  }
}

TEST(DenseField, TakesAnyColumnAndAnyOrigin) {
  const double huge = std::numeric_limits<double>::max();
  const double infinite = std::numeric_limits<double>::infinity();
  const auto field = street_field();
  const std::array columns{-719.5, .5, 720.5, 1e300, -1e300, huge, -huge, kNan, infinite};
  std::array<double, columns.size()> ranges{};
  for (const bool masked : {true, false}) {
    field->evaluate_row(9.3, columns, masked, ranges);
    EXPECT_NEAR(ranges[0], ranges[1], 1e-9);
    EXPECT_NEAR(ranges[2], ranges[1], 1e-9);
    for (std::size_t i = 3; i < 7; ++i) EXPECT_GT(ranges[i], 0) << columns[i];
    EXPECT_TRUE(std::isnan(ranges[7]) && std::isnan(ranges[8]));
    for (const double row : {kNan, infinite, -infinite}) {
      field->evaluate_row(row, columns, masked, ranges);
      for (const double range : ranges) EXPECT_TRUE(std::isnan(range));
    }
  }
  const auto moving = std::make_shared<RingField>(rings(true), 720, street);
  moving->move({.move = {.1, .2, .3}});
  for (const auto& each : {field, dense_field(moving)}) {
    for (const double far : {1e6, 1e300, huge}) {
      const RangeEstimate told = estimate(*each, {{far, -far, far}, {1, 0, 0}});
      EXPECT_EQ(told.seen, Seen::unknown);
      EXPECT_TRUE(std::isnan(told.range_m));
    }
  }
}

TEST(DenseField, JoinsSamplesOfARingUpToTenPercentAndThirtyCentimetres) {
  for (const auto& [other, joined] : {std::pair{5.7, true}, {5.9, false}}) {
    const test::World fence = [far = other](const Vec3&, const Vec3& direction) {
      const auto column =
          static_cast<int>(std::lround((azimuth_of(direction) / kDegree + 180) * 2));
      return column % 2 == 0 ? 5 : far;
    };
    const auto field = dense_field(std::make_shared<RingField>(rings(false), 720, fence));
    const Vec3 half_way = field->lattice().direction(6, 300.5);
    const double told = estimate(*field, {{}, half_way}).range_m;
    EXPECT_EQ(told > 5.1 && told < other - .1, joined) << told;
  }
}

TEST(DenseField, DrawsNoLinesBetweenSamplesOnOppositeSides) {
  const test::World room = [](const Vec3&, const Vec3& direction) {
    return 8 / std::hypot(direction.x, direction.y);
  };
  for (const std::uint32_t other : {3U, 4U, 5U}) {
    const auto plain = std::make_shared<RingField>(rings(false), 8, room);
    for (std::uint32_t row = 0; row < 16; ++row) {
      for (std::uint32_t column = 1; column < 8; ++column) {
        if (column != other) plain->clear(row, column);
      }
    }
    const auto field = dense_field(plain);
    for (double column = .1; column < 8; column += .3) {
      const Vec3 direction = plain->lattice().direction(6.3, column);
      const RangeEstimate told = estimate(*field, {{}, direction});
      if (std::isnan(told.range_m)) continue;
      EXPECT_NEAR(told.range_m, room({}, direction), .5) << other << ' ' << column;
    }
  }
}

TEST(DenseField, PlacesWhatItEvaluates) {
  const auto field =
      dense_field(std::make_shared<RingField>(rings(true), 720, test::plane({0, 1, 0}, 8)));
  const std::array columns{500.6, 510.3, 533.9};
  std::array<double, 3> ranges{};
  std::array<Vec3, 3> points;
  for (const double row : {0.0, 3.2, 7.5, 14.9, 15.0}) {
    field->evaluate_row(row, columns, true, ranges);
    field->place_row(row, columns, ranges, points);
    for (const Vec3& p : points) EXPECT_NEAR(p.y, 8, 1e-3) << row;
  }
}

TEST(DenseField, EvaluatesHalfARowBeyondTheOutermostOnes) {
  const auto field =
      dense_field(std::make_shared<RingField>(rings(false), 720, test::plane({0, 1, 0}, 8)));
  const std::array columns{510.3, kNan};
  std::array<double, 2> ranges{};
  std::array<Vec3, 2> points;
  for (const double row : {-.4, 15.4}) {
    field->evaluate_row(row, columns, true, ranges);
    field->place_row(row, columns, ranges, points);
    EXPECT_NEAR(points[0].y, 8, 1e-6) << row;
    EXPECT_TRUE(std::isnan(ranges[1]));
  }
  field->evaluate_row(-2, columns, true, ranges);
  EXPECT_TRUE(std::isnan(ranges[0]));
}

TEST(DenseField, IsTheSameForAnyThreadsAndOrder) {
  const auto field = street_field();
  std::vector<Sightline> lines;
  for (std::size_t i = 0; i < 20000; ++i) {
    const double k = static_cast<double>(i);
    lines.push_back({{0, 0, .01 * std::sin(k)},
                     direction_of(.3 * std::sin(k * 1.7) - .1, std::remainder(k * 2.4, 6.283))});
  }
  std::vector<RangeEstimate> once(lines.size()), many(lines.size()), backwards(lines.size());
  field->range_along(lines, once, 1);
  field->range_along(lines, many, 5);
  std::reverse(lines.begin(), lines.end());
  field->range_along(lines, backwards, 3);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto same = [&](const RangeEstimate& other) {
      return once[i].seen == other.seen && once[i].confidence == other.confidence &&
             (once[i].range_m == other.range_m ||
              (std::isnan(once[i].range_m) && std::isnan(other.range_m)));
    };
    ASSERT_TRUE(same(many[i]) && same(backwards[lines.size() - 1 - i])) << i;
  }
}

TEST(DenseField, LooksThroughTheMotionOfTheScan) {
  const auto plain = std::make_shared<RingField>(rings(true), 720, test::plane({0, 1, 0}, 8));
  RigidMotion motion;
  const double c = std::cos(.2), s = std::sin(.2);
  motion.rotation = {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
  motion.move = {.3, -.2, .1};
  plain->move(motion);
  const auto field = dense_field(plain);
  std::size_t seen = 0;
  for (double around = 60; around < 130; around += 1.3) {
    const Sightline line{{.05, .02, -.1}, direction_of(-.11, around * kDegree)};
    const RangeEstimate told = estimate(*field, line);
    if (!told.valid()) continue;
    const Vec3 own = motion.undo(line.origin + line.direction * told.range_m);
    EXPECT_NEAR(own.y, 8, 1e-5) << around;
    ++seen;
  }
  EXPECT_GT(seen, 40u);
}

TEST(DenseField, NamesTheReturnsThatItStandsOn) {
  const auto plain = std::make_shared<RingField>(rings(false), 720, test::plane({0, 1, 0}, 8));
  const auto field = dense_field(plain);
  const double azimuth = plain->lattice().azimuth(540.25), up = plain->lattice().elevation(6.4);
  const Vec3 direction = direction_of(up, azimuth);
  const Sources sources = field->sources_at(direction * (8 / direction.y));
  double sum = 0, row = 0, column = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    sum += sources.weight[i];
    row += sources.weight[i] * static_cast<double>(sources.cell[i] / 720);
    column += sources.weight[i] * static_cast<double>(sources.cell[i] % 720);
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_NEAR(row, 6.4, .05);
  EXPECT_NEAR(column, 540.25, .05);
}

}  // namespace
}  // namespace curlidar
