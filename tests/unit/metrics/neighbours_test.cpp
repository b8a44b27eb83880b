// SPDX-License-Identifier: BSD-3-Clause
#include "cloud/neighbours.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/metric_clouds.hpp"

namespace curlidar {
namespace {

using test::cloud_of;
using test::holey_cloud;
using test::kNan;
using test::nearest_slots;
using test::returns_by_distance;

// Steps that are powers of two: distances on the grid are exact, so ties are ties.
TEST(ReturnTree, FindsTheNearestInOrderTiesByNumber) {
  for (const double step : {0.5, 4.0}) {
    Cloud cloud = holey_cloud(400, 5, step);
    for (Vec3& p : cloud.positions) p.z = std::round(p.z) * step;
    const Cloud queries = holey_cloud(80, 6, step);
    const ReturnTree tree(cloud, queries);
    EXPECT_EQ(tree.size(), count_returns(cloud));
    std::vector<Neighbour> found(12);
    for (const Vec3& query : queries.positions) {
      if (!is_return(query)) continue;
      const std::vector<std::size_t> expected = returns_by_distance(cloud, query);
      ASSERT_EQ(tree.nearest(query, found), found.size());
      for (std::size_t k = 0; k < found.size(); ++k) {
        ASSERT_DOUBLE_EQ(found[k].distance, norm(cloud.positions[expected[k]] - query));
        ASSERT_EQ(found[k].slot, expected[k]) << "neighbour " << k;
      }
    }
  }
}

TEST(ReturnTree, FewerReturnsThanAskedFor) {
  const Cloud cloud = cloud_of({{kNan, 0, 0}, {5, 0, 0}, {0, 0, 0}, {2, 0, 0}});
  const ReturnTree tree(cloud, cloud);
  std::vector<Neighbour> found(5);
  ASSERT_EQ(tree.nearest({1, 0, 0}, found), 2u);
  EXPECT_EQ(found[0].slot, 3u);
  EXPECT_EQ(found[1].slot, 1u);
  EXPECT_DOUBLE_EQ(found[1].distance, 4);
  const Cloud nothing = cloud_of({{0, 0, 0}});
  EXPECT_EQ(ReturnTree(nothing, cloud).nearest({1, 0, 0}, found), 0u);
}

TEST(NearestReturns, AgreesWithBruteForce) {
  Cloud a = holey_cloud(300, 1, 0.5);
  Cloud b = holey_cloud(500, 2, 0.5);
  for (Vec3& p : a.positions) p.z = std::round(p.z);
  for (Vec3& p : b.positions) p.z = std::round(p.z);
  const std::vector<std::size_t> expected = nearest_slots(a, b);
  const auto found = nearest_returns(a, b, 2);
  ASSERT_TRUE(found);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(std::isnan((*found)[i].distance), !is_return(a.positions[i]));
    if (!is_return(a.positions[i])) continue;
    ASSERT_EQ((*found)[i].slot, expected[i]) << "point " << i;
  }
}

}  // namespace
}  // namespace curlidar
