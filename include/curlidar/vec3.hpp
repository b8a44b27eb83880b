// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace curlidar {

/// A point or a direction in the sensor frame: x forward, y left, z up; metres.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(const Vec3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// Elevation above the xy plane, radians in [-pi/2, pi/2].
inline double elevation_of(const Vec3& p) { return std::atan2(p.z, std::hypot(p.x, p.y)); }
/// Azimuth, counter-clockwise from +x seen from above, radians in (-pi, pi].
inline double azimuth_of(const Vec3& p) { return std::atan2(p.y, p.x); }
/// Unit vector of an (elevation, azimuth) pair in radians.
inline Vec3 direction_of(double elevation, double azimuth) {
  const double c = std::cos(elevation);
  return {c * std::cos(azimuth), c * std::sin(azimuth), std::sin(elevation)};
}

}  // namespace curlidar
