// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "curlidar/map_view.hpp"
#include "map/tile_points.hpp"
#include "support/map_scenes.hpp"

namespace curlidar {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

MapScene scene_of(MapTile tile, double gap_cells = 0.25) {
  std::vector<MapTile> tiles;
  tiles.push_back(std::move(tile));
  auto scene = MapScene::make(std::move(tiles), {gap_cells});
  EXPECT_TRUE(scene) << scene.error().message;
  return std::move(*scene);
}

/// Directions all around.
Vec3 direction(std::size_t i) {
  const double z = 1 - 2 * std::fmod(0.618033988749895 * static_cast<double>(i) + 0.5, 1.0);
  return direction_of(std::asin(z), 2.399963229728653 * static_cast<double>(i));
}

TEST(MapScene, RaysMeetTheWallsOfABox) {
  const MapScene scene = scene_of(test::box_tile(6, 4, 2));
  EXPECT_FALSE(scene.has_intensity());
  const Vec3 half{6, 4, 2}, from{1.3, -0.7, 0.4};
  for (std::size_t i = 1; i < 5000; ++i) {
    const Vec3 d = direction(i);
    const MapHit hit = scene.cast({from, d});
    const double tx = ((d.x > 0 ? half.x : -half.x) - from.x) / d.x;
    const double ty = ((d.y > 0 ? half.y : -half.y) - from.y) / d.y;
    const double tz = ((d.z > 0 ? half.z : -half.z) - from.z) / d.z;
    const double expected = std::min({tx, ty, tz});
    ASSERT_TRUE(hit.found()) << i;
    ASSERT_NEAR(hit.range_m, expected, 1e-9) << i;
    ASSERT_NEAR(dot(hit.normal, d),
                expected == tx   ? -std::abs(d.x)
                : expected == ty ? -std::abs(d.y)
                                 : -std::abs(d.z),
                1e-12);
    const MapLeaf& leaf = scene.tiles()[hit.tile].leaves[hit.leaf];
    ASSERT_EQ(leaf.axis, expected == tx ? 0 : expected == ty ? 1 : 2);
    ASSERT_FALSE(scene.cast({from, d}, expected * 0.999).found());
    ASSERT_TRUE(scene.cast({from, d}, expected * 1.001).found());
  }
}

TEST(MapScene, ABallOfSmallLeavesIsABall) {
  for (const bool curved : {false, true}) {
    const MapScene scene = scene_of(test::ball_tile(3, 0.25, curved));
    double worst = 0;
    std::size_t missed = 0;
    for (std::size_t i = 0; i < 4000; ++i) {
      const Vec3 d = direction(i), from{0.2, 0.1, -0.3};
      const double b = dot(from, d);
      const double expected = -b + std::sqrt(b * b - dot(from, from) + 9);
      const MapHit hit = scene.cast({from, d});
      if (!hit.found()) {
        ++missed;
        continue;
      }
      worst = std::max(worst, std::abs(hit.range_m - expected));
      const Vec3 inward = (from + d * hit.range_m) * (-1 / 3.0);
      EXPECT_GT(dot(hit.normal, inward), 0.98);
    }
    EXPECT_EQ(missed, 0u);
    // A tangent plane is off by s^2 / 2r at the corner of a slanted cube; second order by less.
    EXPECT_LT(worst, curved ? 0.02 : 0.06);
  }
}

/// The same by walking along the ray: range of the first place that counts, and whether another
/// tolerance of the footprint would have said something else.
struct Walked {
  double range = kInfinity;
  bool doubtful = false;
};
Walked walk(const MapTile& tile, const Vec3& from, const Vec3& d, double reach) {
  const auto component = [](const Vec3& p, std::size_t axis) {
    return axis % 3 == 0 ? p.x : axis % 3 == 1 ? p.y : p.z;
  };
  Walked walked;
  for (const MapLeaf& leaf : tile.leaves) {
    const auto at = [&](double t, double& u, double& v, double& w) {
      const Vec3 p = from + d * t;
      u = component(p, leaf.axis + 1u) - component(leaf.centre, leaf.axis + 1u);
      v = component(p, leaf.axis + 2u) - component(leaf.centre, leaf.axis + 2u);
      w = component(p, leaf.axis);
      return w - leaf_height(leaf, u, v);
    };
    constexpr double kStep = 0.02;
    double u, v, w, before = at(0, u, v, w);
    // Twice as long as its cube is wide, around it.
    const double middle = dot(leaf.centre - from, d);
    const double first = std::max(0.0, middle - 1.5 * leaf.size_m);
    before = at(first, u, v, w);
    for (double t = first; t < std::min(reach, middle + 1.5 * leaf.size_m); t += kStep) {
      const double after = at(t + kStep, u, v, w);
      if ((before < 0) != (after < 0)) {
        double low = t, high = t + kStep;
        for (int i = 0; i < 60; ++i) {
          const double half = 0.5 * (low + high);
          ((at(half, u, v, w) < 0) == (before < 0) ? low : high) = half;
        }
        at(low, u, v, w);
        const double cell = leaf.size_m / leaf.cells;
        const double i = (u + leaf.size_m / 2) / cell, j = (v + leaf.size_m / 2) / cell;
        const double off = std::abs(w - component(leaf.centre, leaf.axis));
        const double limit = leaf.size_m / 2 + kLeafSlack_m;
        const auto edge = [](double x) { return std::abs(x - std::round(x)) < 1e-4; };
        if (edge(i) || edge(j) || std::abs(off - limit) < 1e-4) walked.doubtful = true;
        if (i >= 0 && j >= 0 && i < leaf.cells && j < leaf.cells && off <= limit &&
            tile.footprint[leaf.first_cell + static_cast<std::size_t>(i) * leaf.cells +
                           static_cast<std::size_t>(j)] != 0) {
          walked.range = std::min(walked.range, low);
        }
      }
      before = after;
    }
  }
  return walked;
}

TEST(MapScene, FirstSurfaceIsWhatWalkingAlongTheRayFinds) {
  const MapTile tile = test::random_tile(150, 5);
  const MapScene scene = scene_of(tile, 0);
  std::size_t hits = 0, differ = 0, asked = 0;
  for (std::size_t i = 0; i < 400; ++i) {
    const Vec3 d = direction(i), from = d * -6 + direction(7 * i + 3) * 2;
    const Walked walked = walk(tile, from, d, 12);
    if (walked.doubtful) continue;
    ++asked;
    const MapHit hit = scene.cast({from, d}, 12);
    hits += hit.found();
    // Two crossings within a step are not seen by walking.
    if (hit.range_m != walked.range && !(std::abs(hit.range_m - walked.range) < 1e-6)) ++differ;
  }
  EXPECT_GT(asked, 350u);
  EXPECT_GT(hits, 150u);
  EXPECT_LE(differ, 2u);
}

TEST(MapScene, TheNumberOfThreadsAndTheOrderOfLeavesChangeNothing) {
  MapTile tile = test::random_tile(400, 9), turned = tile;
  std::reverse(turned.leaves.begin(), turned.leaves.end());
  std::vector<MapRay> rays;
  for (std::size_t i = 0; i < 5000; ++i) rays.push_back({direction(3 * i) * 5, direction(i)});
  const MapScene scene = scene_of(tile), other = scene_of(turned);
  const auto one = scene.cast(rays, 100, 1), four = scene.cast(rays, 100, 4);
  const auto back = other.cast(rays, 100, 2);
  ASSERT_EQ(one.size(), rays.size());
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits += one[i].found();
    EXPECT_EQ(one[i].range_m, four[i].range_m);
    EXPECT_EQ(one[i].leaf, four[i].leaf);
    EXPECT_EQ(one[i].range_m, back[i].range_m);
  }
  EXPECT_GT(hits, 1000u);
}

TEST(MapScene, OfEquallyNearLeavesTheFirstIsMet) {
  MapTile tile;
  for (int i = 0; i < 9; ++i) test::add_leaf(tile, {0, 0, 0}, 1, 2, 0.1).intensity = 1;
  const MapScene scene = scene_of(std::move(tile));
  const MapHit hit = scene.cast({{0.1, 0.1, 3}, {0, 0, -1}});
  EXPECT_EQ(hit.leaf, 0u);
  EXPECT_EQ(hit.intensity, 1);
  EXPECT_TRUE(scene.has_intensity());
}

TEST(MapScene, StepsBetweenLeavesAreClosedWhereNothingElseIsBehind) {
  // Two floors with a step of 2 cm between them; a ray from the lower side, flat, through the step.
  MapTile tile;
  test::add_leaf(tile, {0.5, 0.5, 0.5}, 1, 2, 0.5);
  test::add_leaf(tile, {1.5, 0.5, 0.5}, 1, 2, 0.48);
  const Vec3 d = Vec3{-1, 0, -0.2} * (1 / std::sqrt(1.04));
  const Vec3 through{1.0, 0.5, 0.49};
  const MapHit closed = scene_of(tile, 0.5).cast({through - d * 2, d});
  ASSERT_TRUE(closed.found());
  EXPECT_NEAR(closed.range_m, 2, 0.11);
  EXPECT_FALSE(scene_of(tile, 0).cast({through - d * 2, d}).found());
  // Not farther than the gap, and not before surface proper.
  EXPECT_TRUE(scene_of(tile, 0.5).cast({{2.2, 0.5, 2}, {0, 0, -1}}).found());
  EXPECT_FALSE(scene_of(tile, 0.5).cast({{2.3, 0.5, 2}, {0, 0, -1}}).found());
  for (int i = -4; i < 4; ++i) test::add_leaf(tile, {i + 0.5, 0.5, -0.5}, 1, 2, -0.5);
  EXPECT_NEAR(scene_of(tile, 0.5).cast({{2.2, 0.5, 2}, {0, 0, -1}}).range_m, 2.5, 1e-9);
}

TEST(MapScene, HolesInTheFootprintAreHoles) {
  MapTile tile;
  test::add_leaf(tile, {0, 0, 0}, 2, 0, 0.25, 4);
  tile.footprint[1 * 4 + 2] = 0;  // y in [-.5, 0), z in [0, .5)
  const MapScene scene = scene_of(std::move(tile), 0);
  EXPECT_FALSE(scene.cast({{5, -0.25, 0.25}, {-1, 0, 0}}).found());
  EXPECT_NEAR(scene.cast({{5, 0.25, -0.25}, {-1, 0, 0}}).range_m, 4.75, 1e-12);
  EXPECT_NEAR(scene.distance({0.25, -0.25, 0.25}, 1), 0.25, 1e-12);
}

TEST(MapScene, TilesLieAtTheirOrigins) {
  MapTile near, far;
  near.origin = {500000, 5400000, 100};
  far.origin = {500032, 5400000, 100};
  test::add_leaf(near, {31.5, 1.5, 0.5}, 1, 2, 0.5);
  test::add_leaf(far, {0.5, 1.5, 0.5}, 1, 2, 0.75);
  const auto scene = MapScene::make({near, far});
  ASSERT_TRUE(scene);
  EXPECT_NEAR(scene->cast({{500031.5, 5400001.5, 103}, {0, 0, -1}}).range_m, 2.5, 1e-8);
  const MapHit hit = scene->cast({{500032.5, 5400001.5, 103}, {0, 0, -1}});
  EXPECT_NEAR(hit.range_m, 2.25, 1e-8);
  EXPECT_EQ(hit.tile, 1u);
}

/// Distances against those to the nearest of many points of the surface.
void expect_distances(const MapTile& tile, double tolerance) {
  constexpr double kSpacing = 0.01;
  const MapScene scene = scene_of(tile);
  const std::vector<MapSample> points = tile_points(tile, kSpacing);
  for (std::size_t i = 0; i < 40; ++i) {
    const Vec3 p = direction(i) * (5.0 * static_cast<double>(i) / 40);
    double nearest = 6;
    for (const MapSample& sample : points) nearest = std::min(nearest, norm(sample.position - p));
    const double distance = scene.distance(p, 6);
    EXPECT_LE(distance, nearest + tolerance) << i;
    // Half a spacing along u and v, 1.6 times that up for each.
    EXPECT_GE(distance, nearest - 2 * kSpacing) << i;
    EXPECT_EQ(scene.distance(p, distance / 2), distance / 2);
  }
}

TEST(MapScene, DistanceIsThatToTheNearestOfManyPoints) {
  MapTile tile = test::random_tile(12, 21);
  for (MapLeaf& leaf : tile.leaves) leaf.curve = {};
  expect_distances(tile, 1e-9);
  expect_distances(test::ball_tile(2, 0.5, true), 1e-3);
}

TEST(MapScene, WhatMakesNoSenseIsRefusedOrLeftOut) {
  const auto refused = [](auto change) {
    MapTile tile;
    test::add_leaf(tile, {0, 0, 0}, 1, 2, 0);
    change(tile);
    const auto scene = MapScene::make({tile});
    EXPECT_FALSE(scene);
    EXPECT_TRUE(scene || scene.error().code == ErrorCode::invalid_argument);
  };
  refused([](MapTile& t) { t.leaves[0].first_cell = 1; });
  refused([](MapTile& t) { t.leaves[0].first_cell = std::numeric_limits<std::size_t>::max(); });
  refused([](MapTile& t) { t.leaves[0].cells = 0; });
  refused([](MapTile& t) { t.leaves[0].axis = 3; });
  refused([](MapTile& t) { t.leaves[0].size_m = 0; });
  refused([](MapTile& t) { t.leaves[0].slope[1] = NAN; });
  refused([](MapTile& t) { t.origin.x = kInfinity; });
  EXPECT_FALSE(MapScene::make({}, {-0.1}));
  EXPECT_FALSE(MapScene::make({}, {NAN}));

  MapTile tile;
  test::add_leaf(tile, {0, 0, 0}, 1, 2, 5);  // its surface is far outside of its cube
  test::add_leaf(tile, {0, 0, 0}, 1, 2, 0);
  for (std::size_t i = 4; i < 8; ++i) tile.footprint[i] = 0;
  const MapScene empty = scene_of(std::move(tile));
  EXPECT_EQ(empty.leaves(), 0u);
  EXPECT_FALSE(empty.cast({{0, 0, 3}, {0, 0, -1}}).found());
  EXPECT_FALSE(empty.cast({{NAN, 0, 3}, {0, 0, -1}}).found());
  EXPECT_EQ(empty.distance({0, 0, 0}, 2), 2);
}

}  // namespace
}  // namespace curlidar
