// SPDX-License-Identifier: BSD-3-Clause
// Poses: every convention by hand, round trips, errors that name file and line.
#include "curlidar/pose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "curlidar/io.hpp"
#include "support/clouds.hpp"
#include "support/data.hpp"

namespace curlidar {
namespace {

namespace fs = std::filesystem;
using test::to_bytes;
using testing::HasSubstr;
using testing::IsEmpty;

/// The axes of KITTI: the camera looks along z with x to the right and y down, the LiDAR along x
/// with y to the left and z up. Points of the LiDAR become the camera's.
constexpr const char* kAxesSwap = "P0: 1 2 3\nTr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";

double distance(const RigidMotion& a, const RigidMotion& b) {
  double most = norm(a.move - b.move);
  for (std::size_t i = 0; i < 3; ++i) most = std::max(most, norm(a.rotation[i] - b.rotation[i]));
  return most;
}

/// Turned about z by an angle, then moved.
RigidMotion turned(double angle, const Vec3& move) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}}, move};
}

PoseTrack parsed(const std::string& text, std::optional<PoseFormat> format = {}) {
  auto track = parse_poses(to_bytes(text), "p.txt", format);
  if (!track) ADD_FAILURE() << track.error().message;
  return track ? std::move(*track) : PoseTrack();
}

Error error_of(const std::string& text, std::optional<PoseFormat> format = {}) {
  const auto track = parse_poses(to_bytes(text), "p.txt", format);
  EXPECT_FALSE(track) << text.substr(0, 100);
  return track ? Error{} : track.error();
}

class PoseFiles : public testing::Test {
 protected:
  PoseFiles() {
    std::string name = (fs::temp_directory_path() / "curlidar-test-XXXXXX").string();
    directory_ = ::mkdtemp(name.data());
  }
  ~PoseFiles() override { fs::remove_all(directory_); }

  std::string write(const char* name, const std::string& text) const {
    const std::string path = (directory_ / name).string();
    EXPECT_TRUE(write_file(path, to_bytes(text)));
    return path;
  }

  fs::path directory_;
};

TEST(Poses, EveryFormatSaysTheSamePose) {
  // A quarter turn to the left, standing at (1, 2, 3): what lies one metre ahead is at (1, 3, 3).
  const RigidMotion expected{{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}}, {1, 2, 3}};
  for (const char* text : {
           "0 -1 0 1 1 0 0 2 0 0 1 3\n",
           "# a comment\n\n0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3",
           "0 -1 0 1\n1 0 0 2\n0 0 1 3\n",
           "0 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n",
           "0 -1 0 1 1 0 0 2 0 0 1 3 0 0 0 1\n",
           "7.5 1 2 3 0 0 0.70710678118654752 0.70710678118654752\n",
           "7.5 1 2 3 0 0 -0.70710678118654752 -0.70710678118654752\r\n",
           "time,x,y,z,qx,qy,qz,qw\n7.5,1,2,3,0,0,.70710678118654752,.70710678118654752\n",
           "qw;qz;qy;qx;\"z\";y;x;note\n.7071067811865475;.7071067811865475;0;0;3;2;1;99\n",
           "x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22\n1,2,3,0,-1,0,1,0,0,0,0,1\n",
       }) {
    const PoseTrack track = parsed(text);
    ASSERT_EQ(track.T_map_sensor.size(), 1u) << text;
    EXPECT_LT(distance(track.T_map_sensor[0], expected), 1e-15) << text;
    EXPECT_LT(norm(track.T_map_sensor[0]({1, 0, 0}) - Vec3{1, 3, 3}), 1e-14) << text;
  }
}

TEST(Poses, TimesOfTumAndCsv) {
  EXPECT_EQ(parsed("# t x y z q\n7.5 0 0 0 0 0 0 1\n8 0 0 0 0 0 0 1\n").time_s,
            (std::vector<double>{7.5, 8}));
  EXPECT_EQ(parsed("timestamp,x,y,z,qx,qy,qz,qw\n3,0,0,0,0,0,0,1\n").time_s,
            (std::vector<double>{3}));
  EXPECT_THAT(parsed("x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,1\n").time_s, IsEmpty());
}

TEST(Poses, MatricesOneAfterTheOther) {
  const std::string a = "1 0 0 1\n0 1 0 0\n0 0 1 0\n", b = "1 0 0 2\n0 1 0 0\n0 0 1 0\n";
  const std::string last = "0 0 0 1\n";
  for (const std::string& text :
       {a + b, a + "\n" + b, a + last + b + last, a + last + "\n\n" + b + last, a + last + b}) {
    const PoseTrack track = parsed(text);
    ASSERT_EQ(track.T_map_sensor.size(), 2u) << text;
    EXPECT_EQ(track.T_map_sensor[0].move, (Vec3{1, 0, 0}));
    EXPECT_EQ(track.T_map_sensor[1].move, (Vec3{2, 0, 0}));
  }
  EXPECT_THAT(error_of("1 0 0 1\n0 1 0 0\n").message, HasSubstr("line 2: the pose ends after 2"));
  EXPECT_THAT(error_of("1 0 0 1\n0 1 0 0\n\n0 0 1 0\n").message, HasSubstr("after 2 of its 3"));
  EXPECT_THAT(error_of("1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1\n").message, HasSubstr("0 0 0 1"));
}

TEST_F(PoseFiles, StepOfTheCameraAheadIsAStepOfTheLidarAhead) {
  const std::string calib = write("calib.txt", kAxesSwap);
  // The camera goes one metre along its z.
  const std::string poses =
      write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n");
  const auto track = read_poses(poses, {{}, calib, {}});
  ASSERT_TRUE(track) << track.error().message;
  EXPECT_EQ(track->T_map_sensor[0], RigidMotion{});
  EXPECT_EQ(track->T_map_sensor[1].move, (Vec3{1, 0, 0}));
  EXPECT_EQ(track->T_map_sensor[1].rotation, RigidMotion{}.rotation);
}

TEST_F(PoseFiles, TurnOfTheCameraAboutItsDownAxisIsATurnToTheRight) {
  const std::string calib = write("calib.txt", kAxesSwap);
  // A quarter turn about y, which points down, takes z (ahead) to x (right).
  const std::string poses = write("poses.txt", "0 0 1 0 0 1 0 0 -1 0 0 0\n");
  const auto track = read_poses(poses, {{}, calib, {}});
  ASSERT_TRUE(track) << track.error().message;
  EXPECT_LT(norm(track->T_map_sensor[0]({1, 0, 0}) - Vec3{0, -1, 0}), 1e-15);
}

TEST_F(PoseFiles, OffsetOfTheCameraMovesTheLidarInATurn) {
  // The camera's place in the LiDAR's frame is (.27, 0, 0): points shift by -.27 along its z.
  const std::string calib = write("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 -.27\n");
  const std::string poses = write("poses.txt", "0 0 1 0 0 1 0 0 -1 0 0 0\n");  // turns on the spot
  const auto track = read_poses(poses, {{}, calib, {}});
  ASSERT_TRUE(track) << track.error().message;
  // The camera stays at (.27, 0, 0); the LiDAR goes from the origin to .27 m behind it.
  EXPECT_LT(norm(track->T_map_sensor[0].move - Vec3{.27, .27, 0}), 1e-15);
}

TEST_F(PoseFiles, CalibrationsOfOtherKittiFiles) {
  const RigidMotion expected{{{{0, -1, 0}, {0, 0, -1}, {1, 0, 0}}}, {.1, .2, .3}};
  for (const char* text : {"P2: x\nTr: 0 -1 0 .1 0 0 -1 .2 1 0 0 .3\n",
                           "Tr_velo_to_cam: 0 -1 0 .1 0 0 -1 .2 1 0 0 .3\n",
                           "calib_time: 15-Mar\nR: 0 -1 0 0 0 -1 1 0 0\nT: .1 .2 .3\n"}) {
    const auto calib = read_calibration(write("calib.txt", text));
    ASSERT_TRUE(calib) << calib.error().message;
    EXPECT_LT(distance(*calib, expected), 1e-15);
  }
  const auto none = read_calibration(write("calib.txt", "P0: 1 0 0\n"));
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("no line 'Tr:'"));
  const auto few = read_calibration(write("calib.txt", "\nTr: 1 0 0\n"));
  ASSERT_FALSE(few);
  EXPECT_THAT(few.error().message, HasSubstr("calib.txt: line 2: 3 numbers where 12 are wanted"));
}

TEST_F(PoseFiles, WarnsOfFramesThatLookWrong) {
  std::string ahead_z, ahead_x;
  for (int k = 0; k < 5; ++k) {
    ahead_z += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(k) + "\n";
    ahead_x += "1 0 0 " + std::to_string(k) + " 0 1 0 0 0 0 1 0\n";
  }
  const std::string camera = write("camera.txt", ahead_z), lidar = write("lidar.txt", ahead_x);
  const std::string calib = write("calib.txt", kAxesSwap);
  EXPECT_THAT(read_poses(camera)->warnings, testing::ElementsAre(HasSubstr("along its z axis")));
  EXPECT_THAT(read_poses(lidar, {{}, calib, {}})->warnings,
              testing::ElementsAre(HasSubstr("sideways")));
  EXPECT_THAT(read_poses(lidar)->warnings, IsEmpty());
  EXPECT_THAT(read_poses(camera, {{}, calib, {}})->warnings, IsEmpty());
}

TEST_F(PoseFiles, TimesBelongToPoses) {
  const std::string poses =
      write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  const auto track = read_poses(poses, {{}, {}, write("times.txt", "0.000e+00\n1.037e-01\n")});
  ASSERT_TRUE(track) << track.error().message;
  EXPECT_EQ(track->time_s, (std::vector<double>{0, .1037}));
  EXPECT_THAT(track->warnings, IsEmpty());
  const auto few = read_poses(poses, {{}, {}, write("times.txt", "0\n")});
  ASSERT_FALSE(few);
  EXPECT_THAT(few.error().message, testing::AllOf(HasSubstr("times.txt has 1 times"),
                                                  HasSubstr("poses.txt has 2 poses")));
  const auto wrong = read_poses(poses, {{}, {}, write("times.txt", "0\none\n")});
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("times.txt: line 2: 'one' is no finite number"));
  const auto back = read_poses(poses, {{}, {}, write("times.txt", "5\n4\n")});
  ASSERT_TRUE(back);
  EXPECT_THAT(back->warnings, testing::ElementsAre(HasSubstr("time goes back at pose 1")));
  EXPECT_EQ(read_poses((directory_ / "none.txt").string()).error().code, ErrorCode::not_found);
}

TEST_F(PoseFiles, WhatIsWrittenReadsBackTheSame) {
  PoseTrack track;
  for (int k = 0; k < 7; ++k) {
    // Turns by up to a half turn about two axes, so that every case of a quaternion is met.
    const RigidMotion upright = turned(.5236 * k, {k / 3.0, -k * 1e5 / 7, 1e-9 * k});
    const RigidMotion roll{
        {{{1, 0, 0}, {0, std::cos(k), -std::sin(k)}, {0, std::sin(k), std::cos(k)}}}, {}};
    track.T_map_sensor.push_back(upright * roll);
    track.time_s.push_back(1.7e9 + k / 10.0);
  }
  for (const PoseFormat format :
       {PoseFormat::kitti, PoseFormat::tum, PoseFormat::matrix, PoseFormat::csv}) {
    const std::string path = (directory_ / to_string(format)).string();
    ASSERT_TRUE(write_poses(path, track, format));
    const auto back = read_poses(path);  // told by content
    ASSERT_TRUE(back) << back.error().message;
    ASSERT_EQ(back->T_map_sensor.size(), track.T_map_sensor.size());
    const bool exact = format == PoseFormat::kitti || format == PoseFormat::matrix;
    for (std::size_t k = 0; k < track.T_map_sensor.size(); ++k) {
      EXPECT_EQ(back->T_map_sensor[k].move, track.T_map_sensor[k].move);
      EXPECT_LE(distance(back->T_map_sensor[k], track.T_map_sensor[k]), exact ? 0 : 2e-15)
          << to_string(format) << k;
    }
    if (exact) {
      EXPECT_THAT(back->time_s, IsEmpty());
    } else {
      EXPECT_EQ(back->time_s, track.time_s);
    }
    EXPECT_EQ(*pose_format_by_name(to_string(format)), format);
  }
  const std::string times = (directory_ / "times").string();
  ASSERT_TRUE(write_times(times, track.time_s));
  EXPECT_EQ(read_poses((directory_ / "kitti").string(), {{}, {}, times})->time_s, track.time_s);
}

TEST_F(PoseFiles, WritersRefuseWhatTheyCannotHold) {
  PoseTrack track{{RigidMotion{}}, {}, {}};
  EXPECT_THAT(format_poses(track, PoseFormat::tum).error().message, HasSubstr("need times"));
  track.time_s = {1, 2};
  EXPECT_FALSE(format_poses(track, PoseFormat::csv));
  track.time_s = {};
  track.T_map_sensor[0].move.x = std::nan("");
  EXPECT_THAT(format_poses(track, PoseFormat::kitti).error().message, HasSubstr("pose 0"));
  EXPECT_EQ(pose_format_by_name("xml").error().code, ErrorCode::invalid_argument);
}

TEST(Poses, RoundedRotationsBecomeRotations) {
  // Four digits: a turn by .1 rad.
  const PoseTrack track = parsed(".9950 -.0998 0 0 .0998 .9950 0 0 0 0 1 0\n");
  const RigidMotion& pose = track.T_map_sensor[0];
  EXPECT_NEAR(norm(pose.rotation[0]), 1, 1e-15);
  EXPECT_NEAR(dot(pose.rotation[0], pose.rotation[1]), 0, 1e-15);
  EXPECT_LT(distance(pose, turned(.1, {})), 1e-4);
  EXPECT_LT(distance(parsed("0 0 0 0 0 0 .0005 1.0005\n").T_map_sensor[0], turned(.001, {})), 1e-6);
}

TEST(Poses, ErrorsNameTheLineAndWhatToDo) {
  const std::string good = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const auto expect = [](const Error& error, const char* says) {
    EXPECT_EQ(error.code, ErrorCode::corrupt) << error.message;
    EXPECT_THAT(error.message, HasSubstr(says));
    EXPECT_THAT(error.message, HasSubstr("p.txt"));
  };
  expect(error_of(good + "2 0 0 0 0 2 0 0 0 0 2 0\n"), "line 2: the first three columns are no");
  expect(error_of(good + "1 0 0 0 0 1 0 0 0 0 -1 0\n"), "line 2: the rotation's determinant is -1");
  expect(error_of(good + "1 0 0\n"), "line 2: 3 numbers where 12 are wanted");
  expect(error_of(good + "1 0 0 0 0 1 0 0 0 0 1 x\n"), "'x' is no finite number");
  expect(error_of(good + "1 0 0 nan 0 1 0 0 0 0 1 0\n"), "'nan' is no finite number");
  expect(error_of("0 0 0 0 0 0 0 2\n"), "line 1: the quaternion has length 2");
  expect(error_of("0 0 0 0 0 0 0 0\n"), "the quaternion has length 0");
  expect(error_of(""), "no pose in it");
  expect(error_of("# only a comment\n"), "no pose in it");
  expect(error_of("1 2 3\n"), "3 words are no pose");
  expect(error_of("a,b,c\n1,2,3\n"), "line 1: not names of a pose's columns");
  expect(error_of("x,y,z,qx,qy,qz,qw\n"), "no pose in it");
  expect(error_of("x,y,z,qx,qy,qz,qw\n1,2,3\n"), "line 2: 3 numbers where 7 are wanted");
  expect(error_of(good, PoseFormat::tum), "line 1: 12 numbers where 8 are wanted");
  EXPECT_EQ(error_of(std::string(2 << 20, '1')).code, ErrorCode::limit_exceeded);
}

TEST(Poses, KittiSequence00) {
  const auto folder = test::data_directory();
  if (!folder) GTEST_SKIP() << "no real scans (CURLIDAR_DATA)";
  const std::string kitti = (*folder / "kitti_odometry_00").string() + "/";
  const auto track =
      read_poses(kitti + "poses.txt", {{}, kitti + "calib.txt", kitti + "times.txt"});
  ASSERT_TRUE(track) << track.error().message;
  ASSERT_EQ(track->T_map_sensor.size(), 4541u);
  EXPECT_EQ(track->time_s.size(), 4541u);
  EXPECT_THAT(track->warnings, IsEmpty());
  // The car goes ahead, .86 m in the first tenth of a second.
  EXPECT_NEAR(track->T_map_sensor[1].move.x, .86, .03);
  EXPECT_LT(std::abs(track->T_map_sensor[1].move.y), .1);
  EXPECT_THAT(read_poses(kitti + "poses.txt")->warnings,
              testing::ElementsAre(HasSubstr("along its z axis")));
}

}  // namespace
}  // namespace curlidar
