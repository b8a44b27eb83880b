// SPDX-License-Identifier: BSD-3-Clause
// What motion compensation did to a scan, and how to undo it.
#pragma once

#include "curlidar/vec3.hpp"

namespace curlidar {

/// The same 18 numbers as compact::Motion, in radians and metres. A point p at azimuth z of the
/// sensor's own frame, s = z / 2 pi in [-0.5, 0.5) of a turn, was moved to
///   R(rigid_turn) (R(s turn + s^2 turn2) p + s move + s^2 move2) + rigid_move,
/// with R(w) the rotation by |w| about w. All zero: not compensated.
struct MotionTwist {
  Vec3 turn, move;    ///< a turn of the sensor
  Vec3 turn2, move2;  ///< a turn squared
  Vec3 rigid_turn, rigid_move;

  bool none() const { return *this == MotionTwist{}; }
  friend bool operator==(const MotionTwist&, const MotionTwist&) = default;
};

/// R(w) p.
Vec3 rotate(const Vec3& w, const Vec3& p);
/// Where the motion took the point p of the sensor's own frame.
Vec3 apply_motion(const MotionTwist& motion, const Vec3& p);
/// The same with s given, which need not be the azimuth of p.
Vec3 apply_motion_at(const MotionTwist& motion, const Vec3& p, double s);
/// The point that the motion took to `moved`, by fixed-point iteration on s that starts at the
/// azimuth of `moved` plus `turns` (0, or +-1 beside the seam at azimuth pi). Near the seam there
/// may be two such points or none: the result p solves apply_motion_at(motion, p, s) == moved with
/// s the azimuth of p continued over the seam; it is genuine if that s lies in [-0.5, 0.5).
struct Unmoved {
  Vec3 point;
  double s = 0;
};
Unmoved undo_motion(const MotionTwist& motion, const Vec3& moved, double turns = 0);

}  // namespace curlidar
