// SPDX-License-Identifier: BSD-3-Clause
// Points along a sensor's own rays, in integers: the formulas of ray_table.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "compact/fixed_point.hpp"
#include "compact/scan_types.hpp"

namespace curlidar::compact {

/// No coordinate is further out, in Q36 metres: 65 km. Doubles hold all integers up to it.
inline constexpr std::int64_t kFarthestQ36 = std::int64_t{1} << 52;

/// A rotation vector in Q30 radians.
using Turn = std::array<std::int64_t, 3>;

/// R(w) p = p + w x (p + w/2 x (p + w/3 x (...))), ten terms.
FixedPoint turned(const Turn& w, const FixedPoint& p);

/// A range of 1..2^30 Q16 metres in 2^-32 m: 2^16 times it or, if there is a unit (2^-48 m), the
/// multiple nearest to it: round(round(2^32 range / unit) unit / 2^16).
std::int64_t exact_range(std::int32_t range, std::uint64_t unit_q48);

/// The point at a range (2^-32 m, at most 2^47) along a ray at azimuth a and with the elevation
/// `up`, before any motion. With t = range + range_phase 2^16, directions d = round(cos e cos a /
/// 2^30), likewise with sin a, and all halves upwards:
///   x = round((floor(t d_cos / 2^16) - lateral sin a) / 2^10),
///   y = round((floor(t d_sin / 2^16) + lateral cos a) / 2^10),
///   z = round(floor(t sin e / 2^16) / 2^10) + height 2^20.
FixedPoint point_on_ray(const Ray& ray, const SinCos& up, std::uint32_t azimuth,
                        std::int64_t range);

/// The azimuth of that point, a binary angle: a + atan(x) with x = lateral / (t cos e) in Q30,
/// limited to [-1/2, 1/2], and the series of the arc tangent up to x^7.
std::uint32_t azimuth_on_ray(const Ray& ray, const SinCos& up, std::uint32_t azimuth,
                             std::int64_t range);

/// Moves a point seen at an azimuth as the motion of the vehicle did. Rotations are series of ten
/// terms: within 1 um of the true ones for turns of up to .3 rad and points up to 200 m away.
/// Coordinates stop at kFarthestQ36. 0.2 us.
FixedPoint moved(const FixedPoint& point, std::uint32_t azimuth, const Motion& motion);

/// The points of an image's cells, for a table with rays.
class RayPoints {
 public:
  /// `table` has rays, is valid (check_rays), and outlives this.
  RayPoints(const RowTable& table, std::uint32_t rows);

  FixedPoint fixed(std::uint32_t row, std::uint32_t column, std::int32_t range) const;

 private:
  const RayTable& rays_;
  bool moves_;
  std::vector<SinCos> elevations_;
};

}  // namespace curlidar::compact
