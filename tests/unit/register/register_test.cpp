// SPDX-License-Identifier: BSD-3-Clause
// Scans of one simulated street from known places must find those places again.
#include "curlidar/register.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "curlidar/io.hpp"
#include "curlidar/pose.hpp"
#include "curlidar/simulate.hpp"
#include "register/thinning.hpp"
#include "support/data.hpp"

namespace curlidar {
namespace {

using testing::HasSubstr;

/// A scene seen from another place.
class Moved final : public Scene {
 public:
  Moved(const Scene& scene, const RigidMotion& pose) : scene_(scene), pose_(pose) {}
  bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const override {
    return scene_.cast(pose_(origin), pose_.turned(direction), hit);
  }

 private:
  const Scene& scene_;
  RigidMotion pose_;
};

RigidMotion pose(double x, double y, double yaw) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {{{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}}, {x, y, 0}};
}

SensorProfile small_sensor() {
  SensorProfile profile;
  profile.name = "test";
  profile.columns = 600;
  profile.fov_up = 0.15;
  profile.fov_down = -0.4;
  profile.min_range_m = 0.5;
  profile.max_range_m = 100;
  for (int i = 0; i < 32; ++i) profile.rings.push_back({0.15 - 0.55 * i / 31, 0, 0, 0});
  return profile;
}

Cloud scan_from(const RigidMotion& place, std::uint64_t seed) {
  static const auto street = *make_scene("street");
  SimulateSettings settings;
  settings.seed = seed;
  return *simulate(Moved(*street, place), small_sensor(), settings);
}

double angle(const RigidMotion& motion) {
  const auto& [x, y, z] = motion.rotation;
  return std::acos(std::clamp((x.x + y.y + z.z - 1) / 2, -1.0, 1.0));
}

void expect_pose(const RigidMotion& found, const RigidMotion& expected, double within_m) {
  const RigidMotion left = expected.inverse() * found;
  EXPECT_LT(norm(left.move), within_m);
  EXPECT_LT(angle(left), 0.003);
}

TEST(Register, FindsAStepWithAndWithoutAGuess) {
  const RigidMotion place = pose(.8, .1, .02);
  const Cloud target = scan_from({}, 1), source = scan_from(place, 2);
  for (const std::optional<RigidMotion>& guess :
       {std::optional(RigidMotion{}), std::optional<RigidMotion>()}) {
    const auto result = register_pair(source, target, guess);
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->trusted()) << result->doubt;
    expect_pose(result->T_target_source, place, 0.02);
    EXPECT_GT(result->matched_share, .6);
    EXPECT_LT(result->rms_m, .06);
    EXPECT_GT(result->weakest_share, .01);
  }
}

TEST(Register, AStepOfSixMetresIsFoundOrInDoubt) {
  const RigidMotion place = pose(6, -.2, .03);
  const Cloud target = scan_from({}, 1), source = scan_from(place, 2);
  const auto found = register_pair(source, target);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->trusted()) << found->doubt;
  expect_pose(found->T_target_source, place, 0.04);
  // With nothing but a wrong guess it must not be silently wrong.
  RegisterSettings settings;
  settings.search_m = 0;
  const auto lost = register_pair(source, target, RigidMotion{}, settings);
  ASSERT_TRUE(lost);
  EXPECT_FALSE(lost->trusted());
  EXPECT_THAT(lost->doubt, HasSubstr("match"));
}

TEST(Register, ThreadsChangeNothing) {
  const Cloud target = scan_from({}, 1), source = scan_from(pose(.5, 0, .01), 2);
  RegisterSettings settings;
  const auto one = register_pair(source, target, RigidMotion{}, settings);
  settings.threads = 3;
  const auto three = register_pair(source, target, RigidMotion{}, settings);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->T_target_source, three->T_target_source);
  EXPECT_EQ(one->matched_share, three->matched_share);
}

TEST(Register, APlainFloorHoldsNothingSideways) {
  class Floor final : public Scene {
   public:
    bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const override {
      if (direction.z >= 0) return false;
      hit = {(-1.7 - origin.z) / direction.z, .5, .5};
      return true;
    }
  };
  const Cloud scan = *simulate(Floor(), small_sensor());
  RegisterSettings settings;
  settings.search_m = 0;
  const auto result = register_pair(scan, scan, RigidMotion{}, settings);
  ASSERT_TRUE(result);
  EXPECT_LT(result->weakest_share, .005);
  EXPECT_THAT(result->doubt, HasSubstr("nothing in the scan says"));
}

TEST(Register, RefusesScansWithoutPoints) {
  const Cloud scan = scan_from({}, 1);
  const auto result = register_pair(scan, Cloud());
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::invalid_argument);
  EXPECT_THAT(result.error().message, HasSubstr("0 returns"));
  RegisterSettings settings;
  settings.source_voxel_m = 0;
  EXPECT_FALSE(register_pair(scan, scan, {}, settings));
}

/// A drive with a turn; the first pose is far from the origin.
struct Drive {
  std::vector<RigidMotion> poses;
  std::vector<Cloud> scans;
};

Drive drive() {
  Drive drive;
  for (int k = 0; k < 6; ++k) {
    const RigidMotion place = pose(.8 * k, .02 * k * k, .015 * k);
    drive.poses.push_back(pose(500000, 4e6, 1) * place);
    drive.scans.push_back(scan_from(place, static_cast<std::uint64_t>(k) + 1));
  }
  return drive;
}

TEST(Register, SequencesFindTheirWayAlone) {
  const Drive d = drive();
  const auto results = register_sequence(d.scans);
  ASSERT_TRUE(results) << results.error().message;
  EXPECT_EQ((*results)[0].T_target_source, RigidMotion{});
  for (std::size_t k = 0; k < d.poses.size(); ++k) {
    EXPECT_TRUE((*results)[k].trusted()) << k << (*results)[k].doubt;
    expect_pose((*results)[k].T_target_source, d.poses[0].inverse() * d.poses[k], 0.03);
  }
}

TEST(Register, GivenPosesAreRefined) {
  const Drive d = drive();
  std::vector<RigidMotion> given = d.poses;
  for (std::size_t k = 1; k < given.size(); ++k) {
    given[k] = given[k] * pose(k % 2 == 0 ? .2 : -.2, .1, .01);
  }
  const auto results = register_sequence(d.scans, given);
  ASSERT_TRUE(results) << results.error().message;
  for (std::size_t k = 0; k < d.poses.size(); ++k) {
    expect_pose((*results)[k].T_target_source, d.poses[k], 0.03);
  }
  EXPECT_FALSE(register_sequence(d.scans, std::span(given).first(2)));
}

TEST(Register, ErrorsOfSequencesNameTheScan) {
  const std::vector<Cloud> scans{scan_from({}, 1), Cloud()};
  const auto results = register_sequence(scans);
  ASSERT_FALSE(results);
  EXPECT_THAT(results.error().message, HasSubstr("scan 1: 0 returns"));
}

TEST(Thinning, KeepsTheFirstPointOfEachCell) {
  const std::vector<Vec3> points{
      {.1, .1, .1}, {.9, .9, .9}, {-.1, .1, .1}, {1.1, 0, 0}, {.5, 0, 0}};
  EXPECT_THAT(registration::thinned(points, 1),
              testing::ElementsAre(points[0], points[2], points[3]));
}

TEST(Register, KittiAgreesWithPosesMadeElsewhere) {
  const auto folder = test::data_directory();
  if (!folder) GTEST_SKIP() << "no real scans (CURLIDAR_DATA)";
  const std::string kitti = (*folder / "kitti_odometry_00").string() + "/";
  const auto expected = read_poses(kitti + "poses_lidar_refined_0-15.txt");
  ASSERT_TRUE(expected);
  ScanMatcher matcher;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto cloud = read_cloud(kitti + "velodyne/00000" + std::to_string(k) + ".bin");
    ASSERT_TRUE(cloud);
    const auto result = matcher.add(*cloud);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_TRUE(result->trusted()) << result->doubt;
    expect_pose(result->T_target_source, expected->T_map_sensor[k], 0.02);
  }
  // Eight scans, some six metres, further on, without a guess.
  const auto first = read_cloud(kitti + "velodyne/000000.bin");
  const auto later = read_cloud(kitti + "velodyne/000008.bin");
  ASSERT_TRUE(first && later);
  const auto far = register_pair(*later, *first);
  ASSERT_TRUE(far);
  EXPECT_TRUE(far->trusted()) << far->doubt;
  expect_pose(far->T_target_source, expected->T_map_sensor[8], 0.06);
}

}  // namespace
}  // namespace curlidar
