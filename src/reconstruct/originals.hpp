// SPDX-License-Identifier: BSD-3-Clause
// The coded returns that are kept, and which invented points would only double them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curlidar/vec3.hpp"

namespace curlidar {

/// Directions in which there is a point already, as seen from the origin.
class TakenDirections {
 public:
  /// `half_width`: how far apart two points of one cell are in azimuth at most, radians.
  TakenDirections(std::span<const Vec3> points, double half_width);
  /// Whether a point lies within half_width in azimuth and `half_height` in elevation.
  bool near(const Vec3& point, double half_height) const;

 private:
  struct Place {
    std::uint32_t sector;
    double elevation, azimuth;
  };

  std::uint32_t sector_of(double azimuth) const;

  double half_width_;
  std::uint32_t sectors_;
  std::vector<Place> places_;  ///< by sector, then elevation
};

/// Places in space where there is a point already.
class TakenPlaces {
 public:
  TakenPlaces(std::span<const Vec3> points, double radius_m);
  /// Whether a point lies within the radius.
  bool near(const Vec3& point) const;

 private:
  struct Place {
    std::uint64_t box;
    Vec3 point;
  };

  double radius_m_;
  std::vector<Place> places_;  ///< by box
};

}  // namespace curlidar
