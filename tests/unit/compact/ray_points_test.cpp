// SPDX-License-Identifier: BSD-3-Clause
#include "compact/ray_points.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "compact/scan_points.hpp"
#include "support/clouds.hpp"

namespace curlidar::compact {
namespace {

using Vector = std::array<double, 3>;

double radians(std::uint32_t angle) {
  return static_cast<std::int32_t>(angle) / 4294967296.0 * 2 * std::numbers::pi;
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Rodrigues' formula.
Vector turned(const Vector& w, const Vector& p) {
  const double angle = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  if (angle == 0) return p;
  const Vector k = {w[0] / angle, w[1] / angle, w[2] / angle};
  const Vector side = cross(k, p);
  const double dot = k[0] * p[0] + k[1] * p[1] + k[2] * p[2];
  Vector out;
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] =
        p[i] * std::cos(angle) + side[i] * std::sin(angle) + k[i] * dot * (1 - std::cos(angle));
  }
  return out;
}

Vector reference_point(const Ray& ray, std::uint32_t elevation, std::uint32_t azimuth,
                       std::int64_t range) {
  const double t = static_cast<double>(range) / 4294967296.0 + ray.range_phase / 65536.0,
               e = radians(elevation);
  const double a = radians(azimuth), u = t * std::cos(e), l = ray.lateral / 65536.0;
  return {u * std::cos(a) - l * std::sin(a), u * std::sin(a) + l * std::cos(a),
          t * std::sin(e) + ray.height / 65536.0};
}

Vector reference_moved(const Vector& p, double s, const Motion& m) {
  const auto q = [](std::int32_t value, int bits) { return std::ldexp(value, -bits); };
  Vector turn, move, rigid_turn, rigid_move;
  for (std::size_t i = 0; i < 3; ++i) {
    turn[i] = s * q(m.turn[i], 30) + s * s * q(m.turn2[i], 30);
    move[i] = s * q(m.move[i], 16) + s * s * q(m.move2[i], 16);
    rigid_turn[i] = q(m.rigid_turn[i], 30);
    rigid_move[i] = q(m.rigid_move[i], 16);
  }
  Vector out = turned(turn, p);
  for (std::size_t i = 0; i < 3; ++i) out[i] += move[i];
  out = turned(rigid_turn, out);
  for (std::size_t i = 0; i < 3; ++i) out[i] += rigid_move[i];
  return out;
}

double distance(const Vector& a, const FixedPoint& fixed) {
  const Vec3 b = to_metres(fixed);
  return std::hypot(a[0] - b.x, a[1] - b.y, a[2] - b.z);
}

std::int32_t between(test::Random& random, std::int32_t limit) {
  const auto span = static_cast<std::uint64_t>(limit) * 2 + 1;
  return static_cast<std::int32_t>(static_cast<std::int64_t>(random.below(span)) - limit);
}

Ray some_ray(test::Random& random) {
  return {static_cast<std::int32_t>(random.next()), between(random, 1 << 15),
          between(random, 1 << 13), between(random, 1 << 12)};
}

/// |turns| <= .3 in all, moves of metres.
Motion some_motion(test::Random& random) {
  Motion motion;
  for (std::size_t i = 0; i < 3; ++i) {
    motion.turn[i] = between(random, 120 << 20);
    motion.turn2[i] = between(random, 40 << 20);
    motion.rigid_turn[i] = between(random, 180 << 20);
    motion.move[i] = between(random, 4 << 16);
    motion.move2[i] = between(random, 1 << 16);
    motion.rigid_move[i] = between(random, 100 << 16);
  }
  return motion;
}

TEST(RayPoints, LieAlongTheirRays) {
  test::Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const Ray ray = some_ray(random);
    const auto azimuth = static_cast<std::uint32_t>(random.next());
    const auto elevation = static_cast<std::uint32_t>(between(random, 1 << 30));
    const auto range = static_cast<std::int64_t>(1 + random.below(200u << 16)) * 65536;
    const FixedPoint p = point_on_ray(ray, sin_cos_q30(elevation), azimuth, range);
    EXPECT_LT(distance(reference_point(ray, elevation, azimuth, range), p), 1e-6);
  }
}

TEST(RayPoints, AzimuthOfThePointIsThatOfItsCoordinates) {
  test::Random random(2);
  for (int i = 0; i < 3000; ++i) {
    const Ray ray = some_ray(random);
    const auto azimuth = static_cast<std::uint32_t>(random.next());
    const auto elevation = static_cast<std::uint32_t>(between(random, 1 << 28));
    const auto range = static_cast<std::int64_t>((2u << 16) + random.below(200u << 16)) * 65536;
    const Vector p = reference_point(ray, elevation, azimuth, range);
    const std::uint32_t found = azimuth_on_ray(ray, sin_cos_q30(elevation), azimuth, range);
    EXPECT_NEAR(std::remainder(radians(found) - std::atan2(p[1], p[0]), 2 * std::numbers::pi), 0,
                2e-7);
  }
}

TEST(RayPoints, MoveAsTheVehicleDid) {
  test::Random random(3);
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    const Motion motion = some_motion(random);
    const FixedPoint p = {between(random, 120 << 16) * (std::int64_t{1} << 20),
                          between(random, 120 << 16) * (std::int64_t{1} << 20),
                          between(random, 20 << 16) * (std::int64_t{1} << 20)};
    const auto azimuth = static_cast<std::uint32_t>(random.next());
    const Vec3 metres = to_metres(p);
    const double s = static_cast<std::int32_t>(azimuth) / 4294967296.0;
    const Vector wanted = reference_moved({metres.x, metres.y, metres.z}, s, motion);
    worst = std::max(worst, distance(wanted, moved(p, azimuth, motion)));
  }
  EXPECT_LT(worst, 2e-6);
  EXPECT_GT(worst, 0);
}

TEST(RayPoints, NoMotionMovesNothing) {
  const FixedPoint p = {123456789012, -98765432109, 5};
  EXPECT_EQ(moved(p, 0x12345678, Motion{}), p);
}

TEST(RayPoints, TableGivesThePointOfRowAndFiring) {
  test::Random random(4);
  RowTable table;
  table.turn_columns = 100;
  table.elevation = {1 << 26, -(1 << 27)};
  table.rays.emplace();
  RayTable& rays = *table.rays;
  rays.slots = 4000;
  for (std::uint32_t i = 0; i < 100; ++i) rays.firings.push_back(40 * i + i % 3);
  rays.rays = {some_ray(random), some_ray(random)};
  for (const bool moves : {false, true}) {
    if (moves) rays.motion = some_motion(random);
    const PointTable points(table, 2, 100);
    for (std::uint32_t row = 0; row < 2; ++row) {
      for (std::uint32_t column = 0; column < 100; ++column) {
        // Firing f of a row lies in column f + shift.
        const std::uint32_t firing =
            (column + 200 - static_cast<std::uint32_t>(rays.column_shift(row) + 100)) % 100;
        const std::uint32_t azimuth =
            0x80000000u +
            static_cast<std::uint32_t>((std::uint64_t{rays.firings[firing]} << 32) / 4000) +
            static_cast<std::uint32_t>(rays.rays[row].azimuth_offset);
        Vector wanted =
            reference_point(rays.rays[row], static_cast<std::uint32_t>(table.elevation[row]),
                            azimuth, std::int64_t{20} << 32);
        const double s = std::remainder(std::atan2(wanted[1], wanted[0]) / 2 / std::numbers::pi, 1);
        if (std::abs(s) > .49) continue;  // the seam is a matter of rounding
        wanted = reference_moved(wanted, s, rays.motion);
        const FixedPoint p = points.fixed(row, column, 20 << 16);
        EXPECT_LT(distance(wanted, p), 3e-6) << row << ' ' << column << ' ' << moves;
      }
    }
  }
}

TEST(RayPoints, RangesAreRoundedToTheirUnit) {
  constexpr std::uint64_t unit = 562949953421;  // 2 mm
  for (const std::int32_t k : {1, 2, 333, 59999}) {
    const auto exact = static_cast<std::int64_t>(k * unit + 32768) >> 16;
    const auto range = static_cast<std::int32_t>(shift_right_round(exact, 16));
    EXPECT_EQ(exact_range(range, unit), exact);
    EXPECT_EQ(exact_range(range, 0), range * std::int64_t{65536});
  }
}

TEST(RayPoints, TakeAnyNumbers) {
  constexpr auto least = std::numeric_limits<std::int32_t>::min();
  constexpr auto most = std::numeric_limits<std::int32_t>::max();
  test::Random random(5);
  const auto any = [&]() -> std::int32_t {
    const std::uint64_t kind = random.below(4);
    return kind == 0   ? least
           : kind == 1 ? most
           : kind == 2 ? 0
                       : static_cast<std::int32_t>(random.next());
  };
  for (int i = 0; i < 3000; ++i) {
    const Ray ray = {any(), any(), any(), any()};
    Motion motion;
    for (Motion::Triple* triple : {&motion.turn, &motion.move, &motion.turn2, &motion.move2,
                                   &motion.rigid_turn, &motion.rigid_move}) {
      for (std::int32_t& value : *triple) value = any();
    }
    const SinCos up = sin_cos_q30(static_cast<std::uint32_t>(any()));
    const auto azimuth = static_cast<std::uint32_t>(any());
    const auto range = static_cast<std::int64_t>(random.below(std::uint64_t{1} << 47));
    const FixedPoint p = moved(point_on_ray(ray, up, azimuth, range),
                               azimuth_on_ray(ray, up, azimuth, range), motion);
    EXPECT_LE(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), kFarthestQ36);
  }
}

}  // namespace
}  // namespace curlidar::compact
