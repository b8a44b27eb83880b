// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curlidar {
namespace {

SensorProfile sensor() {
  SensorProfile profile;
  profile.name = "test";
  profile.columns = 180;
  profile.fov_up = 0.1;
  profile.fov_down = -0.4;
  profile.min_range_m = 0.5;
  profile.max_range_m = 80;
  for (int i = 0; i < 8; ++i) profile.rings.push_back({0.1 - 0.5 * i / 7, 0, 0, 0});
  return profile;
}

const SimulateSettings kExact{.range_noise_m = 0, .dropout = 0};

Drive made(const DriveSettings& settings) {
  return std::move(Drive::make(settings).value());
}

TEST(Drive, PosesTurnOnceALapAndLookAhead) {
  const Drive drive = made({.scans = 200, .laps = 1});
  double way = 0, turn = 0;
  for (std::size_t i = 0; i < drive.scans(); ++i) {
    const RigidMotion pose = drive.T_map_sensor(i);
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(dot(pose.rotation[r], pose.rotation[c]), r == c ? 1 : 0, 1e-12);
      }
    }
    const RigidMotion next = drive.T_map_sensor((i + 1) % drive.scans());
    const Vec3 step = pose.undo(next.move);
    way += norm(step);
    EXPECT_GT(step.x, 0.9 * norm(step)) << i;
    const Vec3 ahead = pose.turned_back(next.turned({1, 0, 0}));
    turn += std::atan2(ahead.y, ahead.x);
  }
  EXPECT_NEAR(turn, 2 * std::acos(-1.0), 0.1);
  EXPECT_NEAR(way, drive.lap_m() + 2 * std::acos(-1.0) * 1.7, 2);  // in the outer lane
}

TEST(Drive, ScansLieOnTheTruthWhereNothingMoves) {
  const Drive drive = made({.scans = 3, .step_m = 20, .traffic = false});
  for (std::size_t i = 0; i < drive.scans(); ++i) {
    const Cloud scan = drive.scan(i, sensor(), kExact).value();
    const Cloud truth = drive.truth(i, sensor(), kExact).value();
    ASSERT_EQ(scan.size(), truth.size());
    ASSERT_GT(scan.size(), 600u);
    const RigidMotion pose = drive.T_map_sensor(i);
    for (std::size_t k = 0; k < scan.size(); ++k) {
      ASSERT_LT(norm(pose(scan.positions[k]) - truth.positions[k]), 1e-4);
    }
  }
}

TEST(Drive, WhatMovesIsInScansAndNotInTheTruth) {
  const Drive drive = made({.scans = 8, .step_m = 15});
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < drive.scans(); ++i) {
    const Cloud scan = drive.scan(i, sensor(), kExact).value();
    const Cloud truth = drive.truth(i, sensor(), kExact).value();
    double near = 0, far = 0;
    const RigidMotion pose = drive.T_map_sensor(i);
    for (const Vec3& p : scan.positions) near += norm(p);
    for (const Vec3& p : truth.positions) far += norm(pose.undo(p));
    hidden += near < far ? 1 : 0;
  }
  EXPECT_GE(hidden, 6u);
}

TEST(Drive, MarksTellWhatMoves) {
  const Drive drive = made({.scans = 4, .step_m = 15});
  SimulateSettings marked = kExact;
  marked.mark_moving = true;
  std::size_t moving = 0;
  for (std::size_t i = 0; i < drive.scans(); ++i) {
    const Cloud scan = drive.scan(i, sensor(), marked).value();
    const Cloud truth = drive.truth(i, sensor(), kExact).value();
    const RigidMotion pose = drive.T_map_sensor(i);
    const Attribute* marks = scan.find("moving");
    ASSERT_NE(marks, nullptr);
    // Both lists follow the beams; the scan may have more, where a mover hides the sky.
    std::size_t at = 0;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (marks->as_double(k) != 0) {
        ++moving;
        continue;
      }
      const Vec3 p = pose(scan.positions[k]);
      while (at < truth.size() && norm(truth.positions[at] - p) > 1e-4) ++at;
      ASSERT_LT(at, truth.size()) << i << ' ' << k;
    }
    EXPECT_EQ(drive.scan(i, sensor(), kExact).value().find("moving"), nullptr);
  }
  EXPECT_GT(moving, 5u);
}

TEST(Drive, AStillSensorSeesOthersMove) {
  const Drive drive = made({.scans = 20, .still = true});
  EXPECT_EQ(drive.T_map_sensor(0), drive.T_map_sensor(19));
  EXPECT_NE(drive.scan(0, sensor(), kExact).value().positions,
            drive.scan(19, sensor(), kExact).value().positions);
  EXPECT_EQ(drive.truth(0, sensor()).value().positions,
            drive.truth(19, sensor()).value().positions);
}

TEST(Drive, ThreadsChangeNothingAndNoiseIsNewInEveryScan) {
  const Drive drive = made({.scans = 2, .still = true, .traffic = false});
  const Cloud first = drive.scan(0, sensor()).value();
  EXPECT_EQ(first.positions, drive.scan(0, sensor(), {.threads = 3}).value().positions);
  EXPECT_NE(first.positions, drive.scan(1, sensor()).value().positions);
}

TEST(Drive, TheSecondLapSeesTheSameStreetFromOtherPlaces) {
  const Drive drive = made({.scans = 20, .laps = 2, .traffic = false});
  const Vec3 apart = drive.T_map_sensor(10).move - drive.T_map_sensor(0).move;
  EXPECT_GT(norm(apart), 0.01);
  EXPECT_LT(norm(apart), 1);
}

TEST(Drive, RefusesWhatMakesNoSense) {
  EXPECT_FALSE(Drive::make({.scans = 0}));
  EXPECT_FALSE(Drive::make({.scans = 1, .laps = -1}));
  EXPECT_FALSE(Drive::make({.scans = 1, .step_m = 0}));
  EXPECT_FALSE(Drive::make({.scans = 1, .laps = std::nan("")}));
}

}  // namespace
}  // namespace curlidar
