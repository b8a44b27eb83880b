// SPDX-License-Identifier: BSD-3-Clause
// Between the samples of worlds that are known.
#include "dense/dense_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
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

}  // namespace
}  // namespace curlidar
