// SPDX-License-Identifier: BSD-3-Clause
// One descent from one guess.
#pragma once

#include <span>

#include "curlidar/register.hpp"
#include "register/target_surface.hpp"

namespace curlidar::registration {

/// The gate of an iteration: from `first_gate_m` down to `last_gate_m`.
struct Descent {
  double first_gate_m = 1.5, last_gate_m = 0.15;
  int iterations = 25;
};

/// Lays `source` on `target` from a guess. Sets all of the result but `doubt`.
Registration align(std::span<const Vec3> source, TargetSurface& target, const RigidMotion& guess,
                   const Descent& descent, const RegisterSettings& settings);

/// How well the moved source covers the target: the mean of 1 / (1 + (d / kOverlapScale)^2) over
/// its points, d the distance to the nearest point. Unlike distances to planes it knows where along
/// a wall a scan belongs.
double overlap(std::span<const Vec3> source, const TargetSurface& target, const RigidMotion& motion,
               std::size_t threads);

/// The angle of a rotation, radians.
double turn_of(const RigidMotion& motion);

}  // namespace curlidar::registration
