// SPDX-License-Identifier: BSD-3-Clause
// What the rings around one line of sight say, before anybody decides.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "dense/ring_points.hpp"

namespace curlidar {

/// A place in the half-plane of one azimuth.
struct PlanePoint {
  double rho = 0, z = 0;
};

/// A line of sight in the half-plane of an azimuth: of unit length if it starts on the spin axis.
struct PlaneLine {
  double azimuth = 0;  ///< in [-pi, pi]
  PlanePoint from;
  PlanePoint along;

  /// Above 0: the place is above the line.
  double side(const PlanePoint& p) const {
    return (p.z - from.z) * along.rho - (p.rho - from.rho) * along.z;
  }
  /// How far along the line it meets that through two places, inverse; 0 or less: never.
  double inverse_to(const PlanePoint& a, const PlanePoint& b) const;
  /// Distance of a place from where the line starts.
  double distance(const PlanePoint& p) const;
};

/// A ring where it crosses the half-plane.
struct RingLook {
  static constexpr double kFill = 8;  ///< columns over which a ring is continued

  std::int32_t ring = -1;   ///< -1: there is none
  bool known = false;       ///< a sample lies within kFill columns, so that `place` is its surface
  bool mixed = false;       ///< `place` lies between samples of one surface on both sides
  PlanePoint place;         ///< else somewhere along the ring's beam
  double r = 0;             ///< distance of `place` from where the line starts, metres
  double near = 1e9;        ///< columns to the nearest sample
  RingSample left, right;   ///< the samples on either side, right.away > 0
  double right_weight = 0;  ///< share of `right` in place

  bool here(double reach = 1.5) const { return known && near <= reach; }
};

/// Everything around a line of sight. `above` and `below` are neighbouring rings.
struct Look {
  PlaneLine line;
  RingLook above, below;    ///< the next rings as seen along the line; one is absent at the edge
  RingLook above2, below2;  ///< the rings beyond these
  double share = 0;         ///< of the way from below to above at which the line passes, 0..1
  double gap = 0;           ///< angle between above and below as seen, radians
};

/// A ring at the line's azimuth. O(1).
RingLook look_at_ring(const RingPoints& points, const PlaneLine& line, std::ptrdiff_t ring);
/// All rings around a line.
Look look_along(const RingPoints& points, const PlaneLine& line);

/// The samples of a ring beside an azimuth, column by column; `kSide` to either side.
struct Neighbours {
  static constexpr int kSide = 8;
  /// By column from the left; distance from where the line starts, 0: no sample.
  std::array<float, 2 * kSide + 1> r{};
  std::array<const RingPoint*, 2 * kSide + 1> point{};

  float at(int column) const { return r[static_cast<std::size_t>(column + kSide)]; }
  /// Samples at most `reach` columns away.
  int count(int reach) const;
};

/// Of a ring that may be absent (-1): then there are none. O(samples).
Neighbours neighbours_of(const RingPoints& points, const PlaneLine& line, std::ptrdiff_t ring);

}  // namespace curlidar
