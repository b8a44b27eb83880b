// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

namespace curlidar {

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180;

/// The one conversion that profiles are read with; sensor_to_toml inverts exactly this rounding.
inline double radians_of(double degrees) {
  return degrees * kRadiansPerDegree;
}
inline double degrees_of(double radians) {
  return radians / kRadiansPerDegree;
}

}  // namespace curlidar
