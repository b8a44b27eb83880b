// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "curlidar/map_view.hpp"
#include "support/map_scenes.hpp"

namespace curlidar {
namespace {

SensorProfile sensor() {
  SensorProfile profile;
  profile.name = "test";
  profile.columns = 90;
  profile.fov_up = 0.3;
  profile.fov_down = -0.4;
  profile.min_range_m = 0.5;
  profile.max_range_m = 50;
  for (int i = 0; i < 8; ++i) profile.rings.push_back({0.3 - 0.1 * i, 0, 0, 0});
  return profile;
}

MapScene box(float intensity = std::numeric_limits<float>::quiet_NaN()) {
  MapTile tile = test::box_tile(6, 4, 2);
  tile.leaves[0].intensity = intensity;
  return std::move(*MapScene::make({tile}));
}

RigidMotion pose(double yaw, const Vec3& move) {
  return {{{{std::cos(yaw), -std::sin(yaw), 0}, {std::sin(yaw), std::cos(yaw), 0}, {0, 0, 1}}},
          move};
}

bool on_wall(const Vec3& p) {
  const auto wall = [](double x, double half) { return std::abs(std::abs(x) - half) < 1e-6; };
  return wall(p.x, 6) || wall(p.y, 4) || wall(p.z, 2);
}

TEST(SampleMap, EveryBeamMeetsTheWallsInTheSensorsFrame) {
  SensorProfile profile = sensor();
  profile.rings[2] = {0.1, 0.03, 0.05, -0.04};
  profile.beam_origin_radius_m = 0.02;
  const RigidMotion at = pose(0.7, {1.5, -1, 0.5});
  const auto cloud = sample_map(box(), profile, at, {true, true, 2});
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->width, 90u);
  ASSERT_EQ(cloud->height, 8u);
  EXPECT_EQ(cloud->find("intensity"), nullptr);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const std::size_t ring = i / 90, column = i % 90;
    const Vec3& p = cloud->positions[i];
    ASSERT_TRUE(is_return(p)) << i;
    EXPECT_TRUE(on_wall(at(p))) << i;
    EXPECT_EQ(cloud->find("ring")->as_double(i), static_cast<double>(ring));
    // On the beam: from its origin, along its direction.
    const Ring& r = profile.rings[ring];
    const double encoder =
        -std::numbers::pi + 2 * std::numbers::pi * static_cast<double>(column) / 90;
    const double azimuth = encoder + r.azimuth_offset;
    const Vec3 origin = Vec3{std::cos(encoder), std::sin(encoder), 0} * 0.02 +
                        Vec3{-std::sin(azimuth), std::cos(azimuth), 0} * r.horizontal_offset_m +
                        Vec3{0, 0, r.vertical_offset_m};
    EXPECT_NEAR(norm(cross(p - origin, direction_of(r.elevation, azimuth))), 0, 1e-9);
    const Vec3 normal{cloud->find("normal_x")->as_double(i), cloud->find("normal_y")->as_double(i),
                      cloud->find("normal_z")->as_double(i)};
    EXPECT_NEAR(norm(normal), 1, 1e-6);
    EXPECT_LT(dot(normal, p - origin), 0);
  }
}

TEST(SampleMap, WithoutOriginsAllBeamsLeaveFromTheSensor) {
  SensorProfile profile = sensor();
  for (Ring& ring : profile.rings) ring.vertical_offset_m = 0.1;
  const auto cloud = sample_map(box(), profile, {}, {false, false, 1});
  ASSERT_TRUE(cloud);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    EXPECT_NEAR(elevation_of(cloud->positions[i]), profile.rings[i / 90].elevation, 1e-12);
  }
}

TEST(SampleMap, OnlyRangesOfTheSensorCount) {
  SensorProfile profile = sensor();
  profile.min_range_m = 4.5;
  profile.max_range_m = 6.5;
  const MapScene scene = box();
  const auto all = sample_map(scene, sensor(), {}), some = sample_map(scene, profile, {});
  ASSERT_TRUE(all);
  ASSERT_TRUE(some);
  std::size_t kept = 0, left = 0;
  for (std::size_t i = 0; i < all->size(); ++i) {
    const double range = norm(all->positions[i]);
    const bool wanted = range >= 4.5 && range <= 6.5;
    EXPECT_EQ(is_return(some->positions[i]), wanted) << range;
    EXPECT_TRUE(wanted || std::isnan(some->positions[i].x));
    (wanted ? kept : left) += 1;
  }
  EXPECT_GT(kept, 100u);
  EXPECT_GT(left, 100u);
}

TEST(SampleMap, IntensityIsThatOfTheLeaf) {
  const auto cloud = sample_map(box(0.5f), sensor(), {});
  ASSERT_TRUE(cloud);
  const Attribute* intensity = cloud->find("intensity");
  ASSERT_NE(intensity, nullptr);
  std::size_t known = 0;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if (std::isnan(intensity->as_double(i))) continue;
    EXPECT_EQ(intensity->as_double(i), 0.5);
    EXPECT_NEAR(cloud->positions[i].x, -6, 1e-9);  // the first leaf of the box
    ++known;
  }
  EXPECT_GT(known, 0u);
  EXPECT_LT(known, 20u);
}

TEST(SampleMapAlong, GivesAPointForEachLineOfSight) {
  const MapScene scene = box(0.5f);
  const RigidMotion at = pose(-0.4, {2, 1, 0});
  Cloud scan;
  for (int i = 0; i < 3000; ++i)
    scan.positions.push_back(direction_of(0.001 * i - 1.5, 0.1 * i) * 3);
  scan.positions[7] = {NAN, 0, 0};
  scan.positions[8] = {0, 0, 0};
  scan.width = 1500, scan.height = 2;
  const auto cloud = sample_map_along(scene, scan, at, 6, {true, true, 2});
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->size(), 3000u);
  EXPECT_EQ(cloud->height, 2u);
  EXPECT_NE(cloud->find("intensity"), nullptr);
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Vec3& p = cloud->positions[i];
    if (!is_return(p)) {
      ++beyond;
      continue;
    }
    EXPECT_TRUE(on_wall(at(p)));
    EXPECT_LE(norm(p), 6 + 1e-9);
    EXPECT_NEAR(norm(p * (1 / norm(p)) - scan.positions[i] * (1.0 / 3)), 0, 1e-9);
  }
  EXPECT_TRUE(std::isnan(cloud->positions[7].x) && std::isnan(cloud->positions[8].x));
  EXPECT_GT(beyond, 10u);
  EXPECT_LT(beyond, 1000u);
  EXPECT_FALSE(sample_map_along(scene, scan, {{}, {0, NAN, 0}}, 6));
}

TEST(SampleMap, ThreadsChangeNothingAndNonsenseIsRefused) {
  const MapScene scene = box();
  const auto one = sample_map(scene, sensor(), {}, {true, true, 1});
  const auto four = sample_map(scene, sensor(), {}, {true, true, 4});
  ASSERT_TRUE(one && four);
  EXPECT_EQ(one->positions, four->positions);
  RigidMotion stretched;
  stretched.rotation[0] = {2, 0, 0};
  EXPECT_FALSE(sample_map(scene, sensor(), stretched));
  EXPECT_FALSE(sample_map(scene, sensor(), {{}, {NAN, 0, 0}}));
  SensorProfile bad = sensor();
  bad.rings.clear();
  EXPECT_FALSE(sample_map(scene, bad, {}));
  SensorProfile flash = sensor();
  flash.pattern = ScanPattern::limited_field;
  const auto refused = sample_map(scene, flash, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::unsupported);
}

}  // namespace
}  // namespace curlidar
