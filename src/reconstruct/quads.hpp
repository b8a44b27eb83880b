// SPDX-License-Identifier: BSD-3-Clause
// The sphere around a scan in quads of some tenths of a degree, and the planes at their corners,
// which tell how much surface each direction shows: r^2 / |cos incidence| for a solid angle.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "reconstruct/view.hpp"

namespace curlidar {

/// Surfaces seen at a smaller cosine show more than can be told.
inline constexpr double kLeastCosine = 0.01;

/// The plane of a surface as seen from the origin; none where nothing is believed.
struct Plane {
  Vec3 normal{};
  double distance = 0;  ///< of the origin; 0: no plane

  bool exists() const { return distance > 0; }
  /// Range along a unit vector, and the square metres that a steradian around it shows.
  double range(const Vec3& direction) const { return distance / cosine(direction); }
  double area(const Vec3& direction) const {
    const double r = range(direction);
    return r * r / cosine(direction);
  }
  double cosine(const Vec3& direction) const {
    return std::max(-dot(normal, direction), kLeastCosine);
  }
};

/// The quads of the sphere that may show something.
struct Sphere {
  double top = 0, row_angle = 0, column_angle = 0;
  std::size_t rows = 0, columns = 0;

  double elevation(double row) const { return top - row * row_angle; }
  double azimuth(double column) const { return -std::numbers::pi + column * column_angle; }
  Vec3 direction(double row, double column) const {
    return direction_of(elevation(row), azimuth(column));
  }
};

/// Around all returns.
Sphere sphere_of(std::span<const Vec3> returns);

/// A quad of the sphere with the planes at its corners: top left, top right, bottom left, right.
struct Quad {
  std::array<Plane, 4> planes;
  std::size_t row = 0, column = 0;
};

/// Square metres that a steradian shows in a direction, if its surface is at `range`: by the planes
/// that it may be on; `weights` are those of the corners.
double area_at(const Quad& quad, const Vec3& direction, const std::array<double, 4>& weights,
               double range);
/// The most that any of its planes shows.
double largest_area(const Quad& quad, const Vec3& direction);
/// Lengths of the longest of its planes from top to bottom and from left to right, metres.
std::array<double, 2> lengths_of(const Quad& quad, const Sphere& sphere);

/// The planes at the corners of all quads, row by row.
class CornerPlanes {
 public:
  /// O(quads) evaluations; threads change nothing.
  CornerPlanes(const ScanView& view, const Sphere& sphere, const ProgressCallback& progress);

  Quad quad(std::size_t row, std::size_t column) const;
  /// Surface in all, about.
  double square_metres(const Sphere& sphere) const;

 private:
  std::vector<std::vector<Plane>> rows_;
};

}  // namespace curlidar
