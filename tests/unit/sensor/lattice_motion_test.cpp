// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "sensor/motion.hpp"
#include "unit/sensor/synthetic.hpp"

namespace curlidar {
namespace {

MotionTwist fast_car() {
  MotionTwist motion;
  motion.turn = {.004, -.003, .12};
  motion.move = {-2.9, .1, .03};
  return motion;
}

MotionTwist everything() {
  MotionTwist motion = fast_car();
  motion.turn2 = {.001, .002, .02};
  motion.move2 = {.2, -.05, .01};
  motion.rigid_turn = {.01, -.02, 1.5};
  motion.rigid_move = {.9, -.1, 1.8};
  return motion;
}

TEST(LatticeMotion, RotatesAboutTheAxis) {
  constexpr double kQuarter = 1.5707963267948966;
  const Vec3 quarter = rotate({0, 0, kQuarter}, {1, 2, 3});
  EXPECT_NEAR(quarter.x, -2, 1e-14);
  EXPECT_NEAR(quarter.y, 1, 1e-14);
  EXPECT_EQ(quarter.z, 3);
  // The series for small angles goes on where the formula ends.
  const Vec3 p{10, -20, 5};
  for (const double angle : {0.0, 1e-9, .001, .0999, .1001, 3.0}) {
    const Vec3 there = rotate(Vec3{.6, 0, .8} * angle, p);
    EXPECT_NEAR(norm(there), norm(p), 1e-12) << angle;
    EXPECT_NEAR(norm(rotate(Vec3{.6, 0, .8} * -angle, there) - p), 0, 1e-12) << angle;
  }
}

TEST(LatticeMotion, IsUndone) {
  test::Random random(1);
  for (const MotionTwist& motion : {MotionTwist{}, fast_car(), everything()}) {
    for (int i = 0; i < 2000; ++i) {
      const double azimuth = 6.2 * (random.uniform() - .5);
      const Vec3 p =
          direction_of(.5 * (random.uniform() - .6), azimuth) * (3 + 100 * random.uniform());
      const Vec3 moved = apply_motion(motion, p);
      const Unmoved back = undo_motion(motion, moved);
      EXPECT_NEAR(norm(apply_motion_at(motion, back.point, back.s) - moved), 0, 1e-9);
      if (std::abs(azimuth) < 2.5) {
        EXPECT_NEAR(norm(back.point - p), 0, 1e-8) << azimuth;
      }
    }
  }
}

TEST(LatticeMotion, FindsPointsBesideTheSeamFromEitherEnd) {
  test::Random random(2);
  const MotionTwist motion = fast_car();
  for (int i = 0; i < 500; ++i) {
    const double azimuth = (i % 2 == 0 ? 1 : -1) * (3.1415926 - .03 * random.uniform());
    const Vec3 p = direction_of(-.1, azimuth) * (5 + 50 * random.uniform());
    const Vec3 moved = apply_motion(motion, p);
    double nearest = 1;
    for (const double turns : {0.0, 1.0, -1.0}) {
      const Unmoved back = undo_motion(motion, moved, turns);
      if (back.s >= -.5 && back.s < .5) nearest = std::min(nearest, norm(back.point - p));
    }
    EXPECT_NEAR(nearest, 0, 1e-8);
  }
}

}  // namespace
}  // namespace curlidar
