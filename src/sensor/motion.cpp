// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/motion.hpp"

#include <cmath>
#include <numbers>

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
// A pass shrinks the error of s by |turn| / 2 pi and less; fast cars turn .2 rad in a scan.
constexpr int kMostPasses = 12;
constexpr double kSettled = 1e-11;  // of s: nanometres at most

}  // namespace

Vec3 rotate(const Vec3& w, const Vec3& p) {
  // Rodrigues' formula with sin|w| / |w| and (1 - cos|w|) / |w|^2, by their series where w is
  // small.
  const double square = dot(w, w);
  double a, b;
  if (square < .01) {
    a = 1 - square * (1.0 / 6 - square * (1.0 / 120 - square / 5040));
    b = 0.5 - square * (1.0 / 24 - square * (1.0 / 720 - square / 40320));
  } else {
    const double angle = std::sqrt(square);
    const double half = std::sin(angle / 2);
    a = std::sin(angle) / angle;
    b = 2 * half * half / square;
  }
  const Vec3 turned = cross(w, p);
  return p + turned * a + cross(w, turned) * b;
}

Vec3 apply_motion_at(const MotionTwist& motion, const Vec3& p, double s) {
  const Vec3 swept = rotate(motion.turn * s + motion.turn2 * (s * s), p) + motion.move * s +
                     motion.move2 * (s * s);
  return rotate(motion.rigid_turn, swept) + motion.rigid_move;
}

Vec3 apply_motion(const MotionTwist& motion, const Vec3& p) {
  return apply_motion_at(motion, p, azimuth_of(p) / kTurn);
}

Unmoved undo_motion(const MotionTwist& motion, const Vec3& moved, double turns) {
  const Vec3 fixed = rotate(motion.rigid_turn * -1, moved - motion.rigid_move);
  double s = azimuth_of(fixed) / kTurn + turns;
  Vec3 p = fixed;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const double square = s * s;
    p = rotate((motion.turn * s + motion.turn2 * square) * -1,
               fixed - (motion.move * s + motion.move2 * square));
    double next = azimuth_of(p) / kTurn;
    next += std::round(s - next);  // stay on this branch over the seam
    const double change = std::abs(next - s);
    s = next;
    if (change < kSettled) break;
  }
  return {p, s};
}

}  // namespace curlidar
