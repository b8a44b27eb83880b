// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/own_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace curlidar {
namespace {

/// A fit that knows the motion; one return is on its lattice, the others are not.
LatticeFit fit_of(std::size_t points, const MotionTwist& motion) {
  LatticeFit fit;
  fit.motion = motion;
  fit.beams.beams = {{.elevation = .1}};
  fit.beams.slots = 4;
  fit.ring_of_point.assign(points, kNoRing);
  fit.firing_of_point.assign(points, kNoFiring);
  fit.range_of_point.assign(points, 0);
  return fit;
}

TEST(OwnFrame, UndoesTheMotionOfEveryReturn) {
  MotionTwist motion;
  motion.turn = {0, 0, .02};
  motion.move = {1.2, .1, 0};
  Cloud own, moved;
  for (double azimuth = -3.1; azimuth < 3.14; azimuth += .1) {
    own.positions.push_back(direction_of(.05, azimuth) * 12);
  }
  own.positions.push_back({0, 0, 0});
  own.positions.push_back({std::numeric_limits<double>::quiet_NaN(), 1, 2});
  moved = own;
  for (Vec3& p : moved.positions) {
    if (is_return(p)) p = apply_motion(motion, p);
  }
  EXPECT_GT(norm(moved.positions[0] - own.positions[0]), .1);
  const Cloud back = in_own_frame(moved, fit_of(moved.size(), motion));
  ASSERT_EQ(back.size(), own.size());
  for (std::size_t i = 0; i + 2 < own.size(); ++i) {
    EXPECT_LT(norm(back.positions[i] - own.positions[i]), 1e-6) << i;
  }
  EXPECT_FALSE(is_return(back.positions[own.size() - 2]));
  EXPECT_FALSE(is_return(back.positions[own.size() - 1]));
}

TEST(OwnFrame, PutsReturnsOnTheirPlaceOfTheLattice) {
  MotionTwist motion;
  motion.move = {.5, 0, 0};
  Cloud moved;
  moved.positions = {{7, 7, 7}};
  LatticeFit fit = fit_of(1, motion);
  fit.ring_of_point = {0};
  fit.firings = {2};
  fit.firing_of_point = {0};
  fit.range_of_point = {5};
  const Vec3 place = in_own_frame(moved, fit).positions[0];
  EXPECT_LT(norm(place - lattice_point(fit.beams, 0, 2, 5)), 1e-12);
}

TEST(OwnFrame, IsTheCloudsWhereNothingMoved) {
  Cloud cloud;
  cloud.positions = {{1, 2, 3}};
  EXPECT_EQ(in_own_frame(cloud, fit_of(1, {})).positions, cloud.positions);
}

}  // namespace
}  // namespace curlidar
