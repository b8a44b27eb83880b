// SPDX-License-Identifier: BSD-3-Clause
#include "mapfile/still_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "simulate/world.hpp"

namespace curlidar {
namespace {

constexpr double kSensorHeight_m = 1.7;

struct SeenPoint {
  Vec3 position{};  ///< in the map
  bool of_moving = false;
};

/// A street: ground, a wall on the left, a pole; a box that crosses from left to right.
scenery::World street(double seconds, bool with_box) {
  scenery::Sketch sketch;
  const scenery::Brush brush(sketch);
  brush.box({-60, -60, -1}, {60, 60, 0});
  brush.box({-60, 9, 0}, {60, 10, 5});
  brush.cylinder({8, -4, 0}, {8, -4, 4}, 0.1);
  if (with_box) {
    const double y = 6 - 2 * seconds;
    brush.of(0.9).box({6, y - 0.4, 0.2}, {7.5, y + 0.4, 1.8});
  }
  return scenery::World(std::move(sketch));
}

/// What 64 x 900 beams see from `pose`, in the sensor's frame; whether the box, with it.
std::vector<SeenPoint> scan(const scenery::World& world, const RigidMotion& pose) {
  constexpr int kRings = 64, kBeams = 900;
  std::vector<SeenPoint> points;
  for (int ring = 0; ring < kRings; ++ring) {
    const double elevation = (-25 + 30.0 * ring / (kRings - 1)) * std::numbers::pi / 180;
    for (int beam = 0; beam < kBeams; ++beam) {
      const Vec3 direction = direction_of(elevation, 2 * std::numbers::pi * (beam + 0.3) / kBeams);
      Hit hit;
      if (!world.cast(pose.move, pose.turned(direction), hit) || hit.range_m > 60) continue;
      points.push_back({direction * hit.range_m, hit.reflectivity > 0.7});
    }
  }
  return points;
}

RigidMotion pose_at(double seconds) {
  const double yaw = 0.1 * seconds;
  RigidMotion pose;
  pose.rotation = {
      {{std::cos(yaw), -std::sin(yaw), 0}, {std::sin(yaw), std::cos(yaw), 0}, {0, 0, 1}}};
  pose.move = {-4 + seconds, 0.2 * seconds, kSensorHeight_m};
  return pose;
}

struct Drive {
  StillFilter filter;
  std::vector<Vec3> still, moving;  ///< in the map
};

Drive drive(bool with_box, bool backwards = false) {
  Drive all;
  constexpr int kScans = 12;
  for (int i = 0; i < kScans; ++i) {
    const double seconds = 0.5 * (backwards ? kScans - 1 - i : i);
    const RigidMotion pose = pose_at(seconds);
    std::vector<Vec3> points;
    for (const SeenPoint& p : scan(street(seconds, with_box), pose)) {
      points.push_back(p.position);
      (p.of_moving ? all.moving : all.still).push_back(pose(p.position));
    }
    EXPECT_TRUE(all.filter.add_scan(points, pose));
  }
  return all;
}

double share(const std::vector<std::uint8_t>& flags) {
  return static_cast<double>(std::count(flags.begin(), flags.end(), 1)) /
         static_cast<double>(flags.size());
}

TEST(StillFilter, TakesWhatMovedAndLeavesTheRest) {
  const Drive all = drive(true);
  ASSERT_GT(all.moving.size(), 2000u);
  ASSERT_EQ(all.filter.scans(), 12u);
  EXPECT_GT(share(*all.filter.moved(all.moving)), 0.8);
  EXPECT_LT(share(*all.filter.moved(all.still)), 0.002);
}

TEST(StillFilter, ASceneThatStandsStillStays) {
  const Drive all = drive(false);
  EXPECT_LT(share(*all.filter.moved(all.still)), 2e-4);
}

TEST(StillFilter, GroundStaysAtAnyDistance) {
  // Below the sensor up to where beams graze it at three degrees.
  const Drive all = drive(true);
  std::vector<Vec3> ground;
  for (int i = 0; i < 300; ++i) {
    const double range = 2 + 0.1 * i, azimuth = 0.7 * i;
    const Vec3 p{range * std::cos(azimuth), range * std::sin(azimuth), 0.03};
    if (p.y < 8.5) ground.push_back(p);
  }
  EXPECT_EQ(share(*all.filter.moved(ground)), 0);
}

TEST(StillFilter, SaysTheSameWhateverTheOrderOfScansAndPoints) {
  const Drive there = drive(true), back = drive(true, true);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < there.moving.size(); i += 7) points.push_back(there.moving[i]);
  for (std::size_t i = 0; i < there.still.size(); i += 97) points.push_back(there.still[i]);
  const auto flags = *there.filter.moved(points);
  EXPECT_EQ(flags, *back.filter.moved(points));
  std::reverse(points.begin(), points.end());
  auto reversed = *there.filter.moved(points);
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(flags, reversed);
  EXPECT_EQ(share(flags) > 0, true);
}

TEST(StillFilter, WithoutScansOrOutOfReachNothingIsKnown) {
  const std::vector<Vec3> points{{1, 2, 3}, {5, 0, 0}};
  StillFilter filter;
  EXPECT_EQ(*filter.moved(points), (std::vector<std::uint8_t>{0, 0}));
  EXPECT_TRUE(filter.moved({})->empty());
  RigidMotion far;
  far.move = {500, 0, 0};
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(filter.add_scan(points, far));
  ASSERT_TRUE(filter.add_scan({}, {}));
  EXPECT_EQ(*filter.moved(points), (std::vector<std::uint8_t>{0, 0}));
}

TEST(SightImage, TellsHiddenPassedAndThere) {
  std::vector<Vec3> points;  // a wall at x = 10
  for (int i = -200; i <= 200; ++i) {
    for (int j = -60; j <= 60; ++j) points.push_back({10, 0.03 * i, 0.03 * j});
  }
  const SightImage image(points);
  for (const double y : {-3.0, 0.0, 0.0123, 4.0}) {
    const Vec3 at_wall{10, y, 0.3};
    EXPECT_EQ(image.of(at_wall), Sight::there) << y;
    EXPECT_EQ(image.of(at_wall * 0.5), Sight::passed) << y;
    EXPECT_EQ(image.of(at_wall * 0.97), Sight::there) << y;
    EXPECT_EQ(image.of(at_wall * 1.5), Sight::unknown) << y;
  }
  EXPECT_EQ(image.of({0, 10, 0}), Sight::unknown);
  EXPECT_EQ(image.of({5, 0, 4}), Sight::unknown);
  EXPECT_EQ(image.of({0, 0, 0}), Sight::unknown);
}

TEST(SightImage, ComesBackFromItsBytes) {
  std::vector<Vec3> points{
      {std::numeric_limits<double>::quiet_NaN(), 0, 0}, {0, 0, 0}, {1e9, 0, 0}};
  for (int i = 0; i < 5000; ++i) {
    points.push_back({10 * std::cos(i * 0.1), 8 * std::sin(i * 0.1), std::sin(i * 0.37)});
  }
  const SightImage image(points);
  const std::vector<std::byte> bytes = image.bytes();
  ASSERT_EQ(bytes.size(), SightImage::kBytes);
  const SightImage back{std::span<const std::byte, SightImage::kBytes>(bytes)};
  EXPECT_EQ(back.bytes(), bytes);
  // Nor does it depend on the order of the points.
  std::reverse(points.begin(), points.end());
  EXPECT_EQ(SightImage(points).bytes(), bytes);
}

}  // namespace
}  // namespace curlidar
