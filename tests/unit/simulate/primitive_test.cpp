// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/primitive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "simulate/random.hpp"

namespace curlidar::scenery {
namespace {

struct Met {
  bool any = false;
  double t = 0;
  Vec3 normal{};
};

Met meet(const Primitive& primitive, const Vec3& origin, const Vec3& direction,
         double t_max = 1e9) {
  Met met;
  met.any = intersect(primitive, origin, direction, t_max, met.t, met.normal);
  if (met.any) met.normal = met.normal * (1 / norm(met.normal));
  return met;
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

Vec3 random_point(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach),
          random.uniform(-reach, reach)};
}

Frame random_frame(Random& random) {
  return {random_point(random, 1), random_point(random, 1), random_point(random, 1),
          random_point(random, 2)};
}

TEST(Primitive, BallIsMetInFrontWithOutwardNormal) {
  const Primitive ball =
      make_primitive(Shape::ball, {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {10, 0, 0}}, 1);
  const Met met = meet(ball, {}, {1, 0, 0});
  ASSERT_TRUE(met.any);
  EXPECT_DOUBLE_EQ(met.t, 8);
  expect_near(met.normal, {-1, 0, 0}, 1e-12);
  EXPECT_FALSE(meet(ball, {}, {-1, 0, 0}).any);
  EXPECT_FALSE(meet(ball, {0, 2.001, 0}, {1, 0, 0}).any);
  EXPECT_FALSE(meet(ball, {}, {1, 0, 0}, 7.9).any);
}

TEST(Primitive, RayFromInsideMeetsTheFarSide) {
  const Primitive ball = make_primitive(Shape::ball, {}, 1);
  EXPECT_DOUBLE_EQ(meet(ball, {}, {0, 0, 1}).t, 1);
  const Primitive block = make_primitive(Shape::block, {}, 1);
  const Met met = meet(block, {0.5, 0, 0}, {1, 0, 0});
  EXPECT_DOUBLE_EQ(met.t, 0.5);
  expect_near(met.normal, {1, 0, 0}, 0);
}

TEST(Primitive, RotatedBoxByAlgebra) {
  const double c = std::sqrt(0.5);  // a cube turned by 45 degrees shows its edge
  const Primitive cube =
      make_primitive(Shape::block, {{c, c, 0}, {-c, c, 0}, {0, 0, 1}, {5, 0, 0}}, 1);
  const Met met = meet(cube, {0, 0.25, 0}, {1, 0, 0});
  ASSERT_TRUE(met.any);
  EXPECT_NEAR(met.t, 5 - std::sqrt(2.0) + 0.25, 1e-12);
  expect_near(met.normal, {-c, c, 0}, 1e-12);
}

TEST(Primitive, ConeSideAndCap) {
  // A cone of height 2 and radius 1 at its foot.
  const Primitive base = make_primitive(Shape::frustum, {{1, 0, 0}, {0, 1, 0}, {0, 0, 2}, {}}, 1);
  Primitive cone = base;
  cone.taper = 0;
  const Met side = meet(cone, {-5, 0, 1}, {1, 0, 0});
  ASSERT_TRUE(side.any);
  EXPECT_NEAR(side.t, 4.5, 1e-12);
  expect_near(side.normal, {-2 / std::sqrt(5.0), 0, 1 / std::sqrt(5.0)}, 1e-12);
  const Met cap = meet(cone, {0.3, 0, -4}, {0, 0, 1});
  ASSERT_TRUE(cap.any);
  EXPECT_DOUBLE_EQ(cap.t, 4);
  expect_near(cap.normal, {0, 0, -1}, 0);
  EXPECT_FALSE(meet(cone, {-5, 0, 2.1}, {1, 0, 0}).any);
  EXPECT_FALSE(meet(cone, {-5, 0.8, 1}, {1, 0, 0}).any);
}

TEST(Primitive, TrianglesOfAQuadLeaveNoGap) {
  const Primitive a = make_primitive(Shape::triangle, {{1, 0, 0}, {1, 1, 0}, {0, 0, 1}, {}}, 1);
  const Primitive b = make_primitive(Shape::triangle, {{1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {}}, 1);
  for (int i = 0; i <= 1000; ++i) {
    const double at = i / 1000.0;  // along the shared diagonal, seen at a slant
    const Vec3 origin{0.3, -0.7, 3};
    const Vec3 direction = Vec3{at, at, 0} - origin;
    EXPECT_TRUE(meet(a, origin, direction).any || meet(b, origin, direction).any) << at;
  }
}

TEST(Primitive, PanelLetsRaysThroughItsArch) {
  Primitive wall = make_primitive(Shape::panel, {{2, 0, 0}, {0, 0.5, 0}, {0, 0, 2}, {}}, 1);
  wall.opening = {0.5, -2, 0, 0.5};  // 1 m half width, open below, arch from z = 0 to 1
  const auto through = [&](double x, double z) { return !meet(wall, {x, -5, z}, {0, 1, 0}).any; };
  EXPECT_TRUE(through(0, 0));
  EXPECT_TRUE(through(0.99, -1.9));
  EXPECT_TRUE(through(0, 0.99));
  EXPECT_FALSE(through(0, 1.01));
  EXPECT_FALSE(through(0.8, 0.8));  // outside the arch, inside its bounding rectangle
  EXPECT_FALSE(through(1.01, -1));
  // At a slant a ray meets the reveal: the inner side at x = 1 faces -x.
  const Met reveal = meet(wall, {0, -1.2, -1}, {1, 1, 0});
  ASSERT_TRUE(reveal.any);
  EXPECT_DOUBLE_EQ(reveal.t, 1);
  expect_near(reveal.normal, {-1, 0, 0}, 1e-12);
  // From below through the vault's crown: it faces down.
  const Met crown = meet(wall, {0, 0, -1}, {0, 0, 1});
  ASSERT_TRUE(crown.any);
  EXPECT_DOUBLE_EQ(crown.t, 2);
  expect_near(crown.normal, {0, 0, -1}, 1e-12);
}

/// The first change of inside/outside along a ray in small steps, refined by bisection.
Met march(const std::function<bool(const Vec3&)>& inside, const Vec3& origin,
          const Vec3& direction) {
  const double step = 2e-3;
  bool was = inside(origin);
  for (double t = step; t < 12; t += step) {
    if (inside(origin + direction * t) == was) continue;
    double low = t - step, high = t;
    for (int i = 0; i < 45; ++i) {
      const double middle = (low + high) / 2;
      (inside(origin + direction * middle) == was ? low : high) = middle;
    }
    return {true, high, {}};
  }
  return {};
}

bool inside_unit(Shape shape, const Vec3& p, double taper, const Opening& hole) {
  const bool in_block = std::abs(p.x) <= 1 && std::abs(p.y) <= 1 && std::abs(p.z) <= 1;
  switch (shape) {
    case Shape::ball:
      return dot(p, p) <= 1;
    case Shape::block:
      return in_block;
    case Shape::frustum:
      return p.z >= 0 && p.z <= 1 && std::hypot(p.x, p.y) <= 1 + (taper - 1) * p.z;
    case Shape::panel: {
      const bool low = std::abs(p.x) <= hole.half_width && p.z >= hole.bottom && p.z <= hole.spring;
      const bool arch = hole.rise > 0 && p.z >= hole.spring &&
                        std::hypot(p.x / hole.half_width, (p.z - hole.spring) / hole.rise) <= 1;
      return in_block && !low && !arch;
    }
    case Shape::triangle:
      break;
  }
  return false;
}

class SolidPrimitive : public testing::TestWithParam<Shape> {};

TEST_P(SolidPrimitive, AgreesWithMarchingUnderRandomMaps) {
  const Shape shape = GetParam();
  Random random(42, static_cast<std::uint64_t>(shape));
  int met_count = 0, disagreements = 0;
  for (int trial = 0; trial < 250; ++trial) {
    const Frame frame = random_frame(random);
    if (std::abs(dot(frame.axis_x, cross(frame.axis_y, frame.axis_z))) < 0.05) continue;
    Primitive primitive = make_primitive(shape, frame, 1);
    if (shape == Shape::frustum) primitive.taper = random.uniform(0, 1);
    primitive.opening = {random.uniform(0.2, 0.9), random.uniform(-1.2, -0.3),
                         random.uniform(-0.2, 0.5), trial % 3 == 0 ? 0 : random.uniform(0.1, 0.4)};
    const Vec3 origin = random_point(random, 3);
    const Vec3 aim = frame.point(random_point(random, 0.9)) - origin;
    const Vec3 direction = aim * (1 / norm(aim));
    const auto inside = [&](const Vec3& p) {
      const Vec3 local =
          Vec3{dot(primitive.row_x, p), dot(primitive.row_y, p), dot(primitive.row_z, p)} +
          primitive.offset;
      return inside_unit(shape, local, primitive.taper, primitive.opening);
    };
    const Met expected = march(inside, origin, direction);
    const Met met = meet(primitive, origin, direction, 12);
    met_count += met.any;
    // Marching may step over a corner thinner than its step; nothing else may differ.
    if (expected.any != met.any || (met.any && std::abs(expected.t - met.t) > 1e-6)) {
      ++disagreements;
      if (met.any && expected.any) {
        EXPECT_LT(met.t, expected.t);
      }
      continue;
    }
    if (!met.any) continue;
    const Vec3 p = origin + direction * met.t;
    const double tiny = 1e-6;
    EXPECT_NE(inside(p + met.normal * tiny), inside(p - met.normal * tiny));
  }
  EXPECT_GT(met_count, 120);
  EXPECT_LE(disagreements, 2);
}

INSTANTIATE_TEST_SUITE_P(Shapes, SolidPrimitive,
                         testing::Values(Shape::ball, Shape::block, Shape::frustum, Shape::panel));

TEST(Primitive, TriangleAgreesWithMoellerTrumbore) {
  Random random(7);
  int met_count = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const Vec3 a = random_point(random, 2), b = random_point(random, 2),
               c = random_point(random, 2);
    const Vec3 normal = cross(b - a, c - a);
    const Primitive triangle =
        make_primitive(Shape::triangle, {b - a, c - a, normal * (1 / norm(normal)), a}, 1);
    const Vec3 origin = random_point(random, 3), direction = random_point(random, 1);
    const Vec3 p = cross(direction, c - a);
    const double determinant = dot(b - a, p);
    const Vec3 s = origin - a;
    const double u = dot(s, p) / determinant;
    const Vec3 q = cross(s, b - a);
    const double v = dot(direction, q) / determinant;
    const double t = dot(c - a, q) / determinant;
    const bool expected = u >= 0 && v >= 0 && u + v <= 1 && t > 0;
    const Met met = meet(triangle, origin, direction);
    ASSERT_EQ(met.any, expected);
    if (!met.any) continue;
    ++met_count;
    EXPECT_NEAR(met.t, t, 1e-9 * (1 + t));
    EXPECT_NEAR(std::abs(dot(met.normal, normal)), norm(normal), 1e-9 * (1 + norm(normal)));
  }
  EXPECT_GT(met_count, 50);
}

TEST(Primitive, BoundsHoldEverySurfacePoint) {
  Random random(9);
  for (const Shape shape : {Shape::ball, Shape::block, Shape::frustum, Shape::triangle}) {
    for (int trial = 0; trial < 300; ++trial) {
      const Frame frame = random_frame(random);
      Primitive primitive = make_primitive(shape, frame, 1);
      primitive.taper = 0.4;
      const Bounds bounds = bounds_of(shape, frame, primitive.taper);
      const Vec3 origin = random_point(random, 4);
      const Vec3 direction = frame.point(random_point(random, 0.6)) - origin;
      const Met met = meet(primitive, origin, direction);
      if (!met.any) continue;
      const Vec3 p = origin + direction * met.t;
      const double slack = 1e-7;  // random maps may be thin
      EXPECT_GE(p.x, bounds.low.x - slack);
      EXPECT_GE(p.y, bounds.low.y - slack);
      EXPECT_GE(p.z, bounds.low.z - slack);
      EXPECT_LE(p.x, bounds.high.x + slack);
      EXPECT_LE(p.y, bounds.high.y + slack);
      EXPECT_LE(p.z, bounds.high.z + slack);
    }
  }
}

}  // namespace
}  // namespace curlidar::scenery
