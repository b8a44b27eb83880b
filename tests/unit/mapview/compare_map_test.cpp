// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "curlidar/map_view.hpp"
#include "support/map_scenes.hpp"

namespace curlidar {
namespace {

/// A floor of size x size metres at z = 0.
MapScene floor_of(int size) {
  MapTile tile;
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      test::add_leaf(tile, {i + 0.5, j + 0.5, 0.5}, 1, 2, 0).intensity = 0.25f;
    }
  }
  return std::move(*MapScene::make({tile}));
}

/// Points every 2.5 cm, at the height.
Cloud carpet(double x, double y, double z) {
  Cloud cloud;
  for (int i = 0; i < static_cast<int>(x * 40); ++i) {
    for (int j = 0; j < static_cast<int>(y * 40); ++j) {
      cloud.positions.push_back({(i + 0.5) / 40, (j + 0.5) / 40, z});
    }
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  return cloud;
}

TEST(CompareMap, AShiftIsSeenFromBothSides) {
  const auto result = compare_map(floor_of(4), carpet(4, 4, 0.07));
  ASSERT_TRUE(result) << result.error().message;
  // 5 cm: ten by ten points in each of the four cells of a leaf.
  EXPECT_EQ(result->map_points, 16u * 400);
  EXPECT_EQ(result->accuracy.count, 16u * 400);
  EXPECT_EQ(result->completeness.count, 160u * 160);
  const double beside = std::hypot(0.0125 * std::sqrt(2.0), 0.07);
  EXPECT_NEAR(result->accuracy.mean, beside, 1e-6);
  EXPECT_NEAR(result->completeness_points.p95, beside, 1e-6);
  // The surface has no gaps between its points.
  EXPECT_NEAR(result->completeness.mean, 0.07, 1e-7);
  EXPECT_NEAR(result->completeness.rms, 0.07, 1e-7);
  EXPECT_NEAR(result->completeness.max, 0.07, 1e-7);
  EXPECT_EQ(result->completeness.within, (std::vector<double>{0, 1, 1}));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(result->f_scores[i], i == 0 ? 0 : 1, 1e-9);
  const Attribute* error = result->samples.find("error");
  ASSERT_NE(error, nullptr);
  EXPECT_NEAR(error->as_double(17), beside, 1e-6);
  EXPECT_EQ(result->samples.find("intensity")->as_double(3), 0.25);
}

TEST(CompareMap, WhatIsMissedAndWhatIsInventedCountOnOneSideEach) {
  // The reference knows a quarter of the floor, and as much that is not on the map.
  Cloud reference = carpet(2, 2, 0);
  for (Vec3 p : carpet(2, 2, 3).positions) reference.positions.push_back(p);
  reference.positions.push_back({NAN, 0, 0});
  MapCompareSettings settings;
  settings.max_distance_m = 0.5;
  const auto result = compare_map(floor_of(4), reference, settings);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->completeness.within[0], 0.5, 1e-9);
  EXPECT_NEAR(result->completeness.capped, 0.5, 1e-9);
  EXPECT_EQ(result->completeness.max, 0.5);
  EXPECT_NEAR(result->completeness.mean, 0.25, 1e-6);
  EXPECT_TRUE(std::isnan(result->reference_errors.back()));
  EXPECT_NEAR(result->accuracy.within[0], 0.25, 0.02);
  const double p = result->accuracy.within[0], r = 0.5;
  EXPECT_NEAR(result->f_scores[0], 2 * p * r / (p + r), 1e-9);

  settings.crop = true;
  const auto cropped = compare_map(floor_of(4), reference, settings);
  ASSERT_TRUE(cropped);
  EXPECT_NEAR(cropped->accuracy.within[0], 1, 1e-9);
  EXPECT_EQ(cropped->accuracy.count, 1600u);
  EXPECT_EQ(cropped->map_points, 6400u);
}

TEST(CompareMap, ASubsetOfThePointsSaysNearlyTheSame) {
  const MapScene scene = floor_of(4);
  const Cloud reference = carpet(2, 4, 0.01);
  MapCompareSettings settings;
  const auto all = compare_map(scene, reference, settings);
  settings.max_points = 3000;
  const auto some = compare_map(scene, reference, settings);
  settings.threads = 3;
  const auto again = compare_map(scene, reference, settings);
  ASSERT_TRUE(all && some && again);
  EXPECT_EQ(some->map_points, all->map_points);
  EXPECT_LE(some->accuracy.count, 3000u);
  EXPECT_GE(some->accuracy.count, 1000u);
  EXPECT_NEAR(some->accuracy.within[0], all->accuracy.within[0], 0.04);
  EXPECT_NEAR(some->completeness.mean, all->completeness.mean, 1e-9);
  EXPECT_EQ(some->samples.positions, again->samples.positions);
  EXPECT_EQ(some->accuracy.mean, again->accuracy.mean);
}

TEST(CompareMap, NothingToCompareIsAnError) {
  const MapScene scene = floor_of(1);
  EXPECT_FALSE(compare_map(scene, Cloud{}));
  EXPECT_FALSE(compare_map(*MapScene::make({}), carpet(1, 1, 0)));
  MapCompareSettings settings;
  settings.crop = true;
  EXPECT_FALSE(compare_map(scene, carpet(1, 1, 5), settings));
  settings = {};
  settings.thresholds = {2};
  EXPECT_FALSE(compare_map(scene, carpet(1, 1, 0), settings));
  settings = {};
  settings.spacing_m = 0;
  EXPECT_FALSE(compare_map(scene, carpet(1, 1, 0), settings));
  settings = {};
  settings.max_points = 0;
  EXPECT_FALSE(compare_map(scene, carpet(1, 1, 0), settings));
}

TEST(PointSubset, IsAllOrAFairPart) {
  PointSubset all(100), some(100), other(100, 2);
  for (int i = 1; i <= 100; ++i) all.add({{static_cast<double>(i), 0, 0}, {}, 0.5f});
  EXPECT_TRUE(all.complete());
  EXPECT_EQ(all.points().size(), 100u);
  all.add({});
  all.add({{NAN, 0, 0}, {}, 1});
  EXPECT_EQ(all.seen(), 100u);
  double mean = 0;
  for (int i = 1; i <= 20000; ++i) {
    some.add({{static_cast<double>(i), 0, 0}, {}, static_cast<float>(i)});
    other.add({{static_cast<double>(i), 0, 0}, {}, static_cast<float>(i)});
  }
  EXPECT_EQ(some.seen(), 20000u);
  EXPECT_FALSE(some.complete());
  ASSERT_LE(some.points().size(), 100u);
  ASSERT_GE(some.points().size(), 33u);
  EXPECT_NE(some.points(), other.points());
  for (const SurfacePoint& point : some.points()) {
    EXPECT_EQ(point.position.x, point.intensity);
    mean += point.position.x / static_cast<double>(some.points().size());
  }
  EXPECT_NEAR(mean, 10000, 3000);
}

TEST(PointSubset, BecomesACloud) {
  PointSubset points(10);
  points.add({{1, 2, 3}, {0, 0, 1}, 0.5f});
  points.add({{4, 5, 6}, {1, 0, 0}});
  const Cloud plain = points.cloud(), normals = points.cloud(true);
  EXPECT_EQ(plain.position_type, ScalarType::float32);
  EXPECT_EQ(plain.width, 2u);
  EXPECT_EQ(plain.find("normal_x"), nullptr);
  EXPECT_EQ(plain.find("intensity")->as_double(0), 0.5);
  EXPECT_EQ(normals.find("normal_z")->as_double(0), 1);
  EXPECT_EQ(normals.find("normal_x")->as_double(1), 1);
  points.add({{500000, 0, 0}, {}, 0});
  EXPECT_EQ(points.cloud().position_type, ScalarType::float64);
}

TEST(MapPoints, LieOnTheSurfaceWithItsNormals) {
  const MapTile ball = test::ball_tile(3, 0.25, true);
  const auto points = map_points({ball}, 0.1, 100000);
  ASSERT_TRUE(points);
  EXPECT_TRUE(points->complete());
  // 4 pi 9 m2; where cubes' surfaces end slanted cells reach over each other.
  EXPECT_GT(points->seen(), 8000u);
  for (const SurfacePoint& point : points->points()) {
    const Vec3 normal{point.normal[0], point.normal[1], point.normal[2]};
    EXPECT_NEAR(norm(point.position), 3, 0.03);
    EXPECT_GT(std::abs(dot(normal, point.position)) / 3, 0.98);
  }
}

}  // namespace
}  // namespace curlidar
