// SPDX-License-Identifier: BSD-3-Clause
#include "paper/outliers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "unit/paper/images.hpp"

namespace curlidar {
namespace {

using test::unit;

Cloud cloud_of(std::vector<Vec3> positions) {
  Cloud cloud;
  cloud.width = static_cast<std::uint32_t>(positions.size());
  cloud.positions = std::move(positions);
  return cloud;
}

std::vector<bool> by_brute_force(const Cloud& cloud, double radius, std::uint32_t min_points) {
  std::vector<bool> keep(cloud.size(), false);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_return(cloud.positions[i])) continue;
    std::uint32_t found = 0;
    for (const Vec3& q : cloud.positions) {
      const Vec3 d = q - cloud.positions[i];
      if (is_return(q) && dot(d, d) <= radius * radius) ++found;
    }
    keep[i] = found >= min_points;
  }
  return keep;
}

TEST(FindInliers, AgreesWithBruteForceOnClusters) {
  test::Random random(51);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec3> points;
  for (int cluster = 0; cluster < 25; ++cluster) {
    const Vec3 centre{40 * unit(random) - 20, 40 * unit(random) - 20, 4 * unit(random) - 2};
    const double spread = 0.2 + 3 * unit(random);
    for (std::uint64_t i = 0; i < 1 + random.below(40); ++i) {
      points.push_back(centre +
                       Vec3{unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5} * spread);
    }
    points.push_back({kNan, 1, 1});
    points.push_back({0, 0, 0});
  }
  const Cloud cloud = cloud_of(points);
  for (const double radius : {0.05, 0.5, 1.0, 7.0}) {
    for (const std::uint32_t needed : {2u, 3u, 7u, 30u}) {
      EXPECT_EQ(find_inliers(cloud, radius, needed), by_brute_force(cloud, radius, needed))
          << radius << " " << needed;
    }
  }
}

TEST(FindInliers, TheRadiusItselfCounts) {
  const Cloud cloud = cloud_of({{10, 0, 0}, {11, 0, 0}, {20, 0, 0}, {21.0000001, 0, 0}});
  EXPECT_EQ(find_inliers(cloud, 1, 2), (std::vector<bool>{true, true, false, false}));
  // On a lattice of 1 m every inner point has exactly seven points within 1 m, itself included.
  std::vector<Vec3> lattice;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        lattice.push_back({10.0 + x, static_cast<double>(y), static_cast<double>(z)});
      }
    }
  }
  const std::vector<bool> keep = find_inliers(cloud_of(lattice), 1, 7);
  EXPECT_EQ(std::count(keep.begin(), keep.end(), true), 27);
}

TEST(FindInliers, SwitchedOffKeepsAllReturns) {
  const Cloud cloud = cloud_of(
      {{1, 0, 0}, {0, 0, 0}, {std::numeric_limits<double>::infinity(), 0, 0}, {500, 500, 500}});
  const std::vector<bool> returns{true, false, false, true};
  EXPECT_EQ(find_inliers(cloud, 0, 7), returns);
  EXPECT_EQ(find_inliers(cloud, 1, 1), returns);
  EXPECT_EQ(find_inliers(cloud, 1, 0), returns);
  EXPECT_TRUE(find_inliers(Cloud{}, 1, 7).empty());
}

TEST(FindInliers, NothingBeyondTheReachOfAnySensorIsKept) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<Vec3> points;
  for (int i = 0; i < 20'000; ++i) points.push_back({1e30, -1e30 * i, 1e30});  // in linear time
  for (int i = 0; i < 5; ++i) points.push_back({-3e200, 2e200, 1});            // the same place
  points.push_back({1e308, 1e308, 1e308});
  points.push_back({kInfinity, 0, 0});
  for (int i = 0; i < 5; ++i) points.push_back({1e8 + i * 0.1, 0, 0});  // far, not out of reach
  const std::vector<bool> keep = find_inliers(cloud_of(points), 1, 3);
  EXPECT_EQ(std::count(keep.begin(), keep.end(), true), 5);
  EXPECT_TRUE(keep.back());
}

}  // namespace
}  // namespace curlidar
