// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/own_frame.hpp"

#include <cmath>

namespace curlidar {
namespace {

/// Beside the seam two places may be meant; the one whose time lies within the turn is.
Vec3 unmoved(const MotionTwist& motion, const Vec3& moved) {
  const Unmoved plain = undo_motion(motion, moved);
  if (plain.s >= -.5 && plain.s < .5) return plain.point;
  const Unmoved other = undo_motion(motion, moved, plain.s < 0 ? 1 : -1);
  return other.s >= -.5 && other.s < .5 ? other.point : plain.point;
}

}  // namespace

Cloud in_own_frame(const Cloud& cloud, const LatticeFit& fit) {
  Cloud own = cloud;
  if (fit.motion.none()) return own;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!is_return(own.positions[i])) continue;
    const std::uint32_t firing = fit.firing_of_point[i];
    own.positions[i] = firing == kNoFiring
                           ? unmoved(fit.motion, own.positions[i])
                           : lattice_point(fit.beams, fit.ring_of_point[i], fit.firings[firing],
                                           fit.range_of_point[i]);
  }
  return own;
}

}  // namespace curlidar
