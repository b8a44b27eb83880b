// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "simulate/random.hpp"

namespace curlidar::scenery {
namespace {

Vec3 random_direction(Random& random) {
  const double elevation = std::asin(random.uniform(-1, 1));
  return direction_of(elevation, random.uniform(-std::numbers::pi, std::numbers::pi));
}

/// A heap of everything, some of it overlapping.
Sketch heap(std::uint64_t seed) {
  Sketch sketch;
  Random random(seed);
  const Brush root(sketch);
  const auto place = [&](double reach) {
    return Vec3{random.uniform(-reach, reach), random.uniform(-reach, reach),
                random.uniform(-reach, reach)};
  };
  for (int i = 0; i < 150; ++i) {
    const Brush turned = root.at(place(12)).turned(random.uniform(0, 6)).of(0.3);
    turned.box({-0.4, -0.2, -0.3}, {0.4, 0.2, 0.3});
    turned.ellipsoid(place(3), {0.3, 0.5, 0.2});
    turned.frustum(place(2), place(2), 0.1, 0.3);
    turned.triangle(place(2), place(2), place(2));
    turned.panel({-1, -0.1, -1}, {1, 0.1, 1}, {0.5, -0.6, 0.1, 0.3});
  }
  return sketch;
}

TEST(World, TreeFindsTheClosestHitOfBruteForce) {
  const Sketch sketch = heap(3);
  const World world(sketch);
  Random random(5);
  int met = 0;
  for (int ray = 0; ray < 3000; ++ray) {
    const Vec3 origin{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    const Vec3 direction = random_direction(random);
    double closest = std::numeric_limits<double>::infinity();
    for (const Primitive& primitive : sketch.primitives) {
      double t = 0;
      Vec3 normal{};
      if (intersect(primitive, origin, direction, closest, t, normal)) closest = t;
    }
    Hit hit;
    const bool any = world.cast(origin, direction, hit);
    ASSERT_EQ(any, std::isfinite(closest));
    if (!any) continue;
    ++met;
    ASSERT_EQ(hit.range_m, closest);
    EXPECT_GE(hit.cos_incidence, 0);
    EXPECT_LE(hit.cos_incidence, 1 + 1e-12);
  }
  EXPECT_GT(met, 1000);
}

TEST(World, RaysAlongTheAxesAreMet) {
  Sketch sketch;
  Brush(sketch).box({2, -1, -1}, {3, 1, 1});
  Brush(sketch).box({-1, -1, 4}, {1, 1, 5});
  const World world(sketch);
  Hit hit;
  ASSERT_TRUE(world.cast({}, {1, 0, 0}, hit));
  EXPECT_DOUBLE_EQ(hit.range_m, 2);
  EXPECT_DOUBLE_EQ(hit.cos_incidence, 1);
  ASSERT_TRUE(world.cast({}, {0, 0, 1}, hit));
  EXPECT_DOUBLE_EQ(hit.range_m, 4);
  EXPECT_FALSE(world.cast({}, {0, 1, 0}, hit));
  EXPECT_TRUE(world.cast({0, 1, 0}, {1, 0, 0}, hit));  // along a face
}

TEST(World, EmptyWorldIsSky) {
  Hit hit;
  EXPECT_FALSE(World(Sketch{}).cast({}, {1, 0, 0}, hit));
}

TEST(World, ManyThingsInOnePlaceDoNotBreakTheTree) {
  Sketch sketch;
  for (int i = 0; i < 500; ++i) Brush(sketch).box({2, -1, -1}, {3, 1, 1});
  Hit hit;
  EXPECT_TRUE(World(std::move(sketch)).cast({}, {1, 0, 0}, hit));
}

TEST(Brush, FrustumOfAnyDirectionHasItsRadii) {
  Sketch sketch;
  Brush(sketch).frustum({5, 0, 0}, {5, 4, 0}, 0.5, 1.5);
  const World world(sketch);
  Hit hit;
  ASSERT_TRUE(world.cast({0, 2, 0}, {1, 0, 0}, hit));  // half way: radius 1
  EXPECT_NEAR(hit.range_m, 4, 1e-12);
  EXPECT_FALSE(world.cast({0, 4.01, 0}, {1, 0, 0}, hit));
}

TEST(Brush, TurnedThenMovedComposes) {
  Sketch sketch;
  const Brush brush = Brush(sketch).at({10, 0, 0}).turned(std::numbers::pi / 2).at({3, 0, 0});
  brush.ellipsoid({}, {1, 1, 1});  // at (10, 3, 0)
  const World world(sketch);
  Hit hit;
  ASSERT_TRUE(world.cast({0, 3, 0}, {1, 0, 0}, hit));
  EXPECT_NEAR(hit.range_m, 9, 1e-12);
}

TEST(Brush, ReflectivityIsTheBrushs) {
  Sketch sketch;
  Brush(sketch).of(0.8).box({2, -1, -1}, {3, 1, 1});
  Hit hit;
  ASSERT_TRUE(World(sketch).cast({}, {1, 0, 0}, hit));
  EXPECT_EQ(hit.reflectivity, 0.8);
}

}  // namespace
}  // namespace curlidar::scenery
