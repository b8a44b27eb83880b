// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/metric_clouds.hpp"

namespace curlidar {
namespace {

using test::brute_force;
using test::cloud_of;
using test::kInf;
using test::kNan;
using test::random_cloud;

TEST(NearestDistances, AgreesWithBruteForce) {
  for (const double step : {0.01, 0.5, 1e6}) {
    const Cloud a = random_cloud(700, 1, step);
    const Cloud b = random_cloud(900, 2, step);
    const auto found = nearest_distances(a, b);
    ASSERT_TRUE(found);
    const auto expected = brute_force(a, b);
    ASSERT_EQ(found->size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR((*found)[i], expected[i], 1e-14 * (1 + 200 * step)) << "point " << i;
    }
  }
}

TEST(NearestDistances, NeverMatchesSlotsWithoutReturn) {
  const Cloud a = cloud_of({{1, 0, 0}, {0, 0, 0}, {kNan, 0, 0}, {0, 0.5, 0}});
  const Cloud b = cloud_of({{0, 0, 0}, {kNan, 1, 1}, {1, 0, kInf}, {4, 0, 0}});
  const auto found = nearest_distances(a, b);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 4u);
  EXPECT_DOUBLE_EQ((*found)[0], 3);
  EXPECT_TRUE(std::isnan((*found)[1]));
  EXPECT_TRUE(std::isnan((*found)[2]));
  EXPECT_DOUBLE_EQ((*found)[3], std::hypot(4, 0.5));
}

TEST(NearestDistances, SameForAnyThreadCount) {
  const Cloud a = random_cloud(9000, 3, 0.37);
  const Cloud b = random_cloud(5000, 4, 0.37);
  const auto one = nearest_distances(a, b, 1);
  const auto three = nearest_distances(a, b, 3);
  const auto all = nearest_distances(a, b, 0);
  ASSERT_TRUE(one && three && all);
  EXPECT_EQ(*one, *three);
  EXPECT_EQ(*one, *all);
}

TEST(NearestDistances, ManyEqualPoints) {
  const Cloud a = cloud_of(std::vector<Vec3>(5000, Vec3{1, 2, 3}));
  const Cloud b = cloud_of(std::vector<Vec3>(5000, Vec3{1, 2, 4}));
  const auto found = nearest_distances(a, b);
  ASSERT_TRUE(found);
  for (const double d : *found) ASSERT_DOUBLE_EQ(d, 1);
}

TEST(NearestDistances, HugeCoordinatesDoNotOverflow) {
  const Cloud a = cloud_of({{3e200, 0, 0}});
  const Cloud b = cloud_of({{0, 4e200, 0}, {0, 9e200, 0}});
  const auto found = nearest_distances(a, b);
  ASSERT_TRUE(found);
  EXPECT_NEAR((*found)[0] / 5e200, 1, 1e-12);
}

TEST(NearestDistances, TargetWithoutReturnIsAnError) {
  const Cloud some = cloud_of({{1, 0, 0}});
  for (const Cloud& none : {cloud_of({}), cloud_of({{0, 0, 0}, {kNan, 0, 0}})}) {
    const auto found = nearest_distances(some, none);
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::invalid_argument);
  }
  const auto from_nothing = nearest_distances(cloud_of({}), some);
  ASSERT_TRUE(from_nothing);
  EXPECT_TRUE(from_nothing->empty());
}

TEST(Compare, BothWaysByHand) {
  const Cloud a = cloud_of({{1, 0, 0}, {2, 0, 0}, {kNan, 0, 0}});
  const Cloud b = cloud_of({{1, 0, 0}, {0, 0, 0}, {2, 0, 0.5}, {2, 0, 10}});
  const auto comparison = compare(a, b);
  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->points_a, 2u);
  EXPECT_EQ(comparison->points_b, 3u);
  EXPECT_DOUBLE_EQ(comparison->a_to_b.mean, 0.25);
  EXPECT_DOUBLE_EQ(comparison->a_to_b.max, 0.5);
  EXPECT_DOUBLE_EQ(comparison->b_to_a.mean, 3.5);
  EXPECT_DOUBLE_EQ(comparison->b_to_a.p50, 0.5);
  EXPECT_DOUBLE_EQ(comparison->b_to_a.max, 10);
}

TEST(Compare, EitherCloudWithoutReturnsIsAnError) {
  const Cloud some = cloud_of({{1, 0, 0}});
  EXPECT_FALSE(compare(some, cloud_of({})));
  EXPECT_FALSE(compare(cloud_of({}), some));
  EXPECT_FALSE(compare(cloud_of({{0, 0, 0}}), some));
}

TEST(Summarise, ByHand) {
  const DistanceStats stats = summarise({4, 1, 3, 2});
  EXPECT_EQ(stats.count, 4u);
  EXPECT_DOUBLE_EQ(stats.mean, 2.5);
  EXPECT_DOUBLE_EQ(stats.rms, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(stats.std, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(stats.p50, 2.5);
  EXPECT_DOUBLE_EQ(stats.p95, 3.85);
  EXPECT_DOUBLE_EQ(stats.max, 4);
}

TEST(Summarise, SingleValueAndNothing) {
  const DistanceStats one = summarise({2});
  EXPECT_EQ(one.count, 1u);
  EXPECT_DOUBLE_EQ(one.mean, 2);
  EXPECT_DOUBLE_EQ(one.std, 0);
  EXPECT_DOUBLE_EQ(one.p95, 2);
  const DistanceStats none = summarise({});
  EXPECT_EQ(none.count, 0u);
  EXPECT_EQ(none.mean, 0);
  EXPECT_EQ(none.p50, 0);
}

TEST(Summarise, LeavesOutNan) {
  const DistanceStats stats = summarise({kNan, 2, kNan, 4});
  EXPECT_EQ(stats.count, 2u);
  EXPECT_DOUBLE_EQ(stats.mean, 3);
}

}  // namespace
}  // namespace curlidar
