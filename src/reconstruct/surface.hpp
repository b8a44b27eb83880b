// SPDX-License-Identifier: BSD-3-Clause
// What one surface is: straight on between two points, by what the field believes half way.
#pragma once

#include <cmath>

#include "curlidar/vec3.hpp"

namespace curlidar {

/// What lies before or behind the straight line between its neighbours by less than this share of
/// their difference in range is on it; at a cliff it is on either side, off by half of that.
inline constexpr double kStraightShare = 0.15;

/// Whether `middle`, seen half way between `a` and `b` from the origin, lies on the straight line
/// between them, but for `noise_m` and the share above. False if any is NaN.
inline bool is_straight(const Vec3& a, const Vec3& middle, const Vec3& b, double noise_m) {
  const double far_a = norm(a), far_b = norm(b);
  const double cosine = dot(a, b) / (far_a * far_b);
  const double half = std::sqrt(std::fmax(0, (1 + cosine) / 2));
  const double chord = 2 * far_a * far_b * half / (far_a + far_b);
  return std::abs(norm(middle) - chord) <= noise_m + kStraightShare * std::abs(far_a - far_b);
}

}  // namespace curlidar
