// SPDX-License-Identifier: BSD-3-Clause
// A world of primitives, and the brush that scenes are drawn with.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/bvh.hpp"
#include "curlidar/simulate.hpp"
#include "simulate/primitive.hpp"

namespace curlidar::scenery {

/// Primitives while a scene is being drawn.
struct Sketch {
  std::vector<Primitive> primitives;
  std::vector<Bounds> bounds;
};

/// A finished world in the sensor's frame.
class World final : public Scene {
 public:
  explicit World(Sketch sketch);
  bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const override;
  const std::vector<Primitive>& primitives() const { return primitives_; }

 private:
  Bvh bvh_;
  std::vector<Primitive> primitives_;  ///< in the order of the tree's leaves
};

/// Adds shapes to a sketch in a local frame and of one reflectivity. Cheap to copy: `at`, `turned`
/// and `of` give brushes for the parts of a thing. The sketch must outlive its brushes.
class Brush {
 public:
  explicit Brush(Sketch& sketch, const Frame& frame = {}) : sketch_(&sketch), frame_(frame) {}

  /// The frame moved to a local point.
  Brush at(const Vec3& position) const { return in({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, position}); }
  /// The frame turned about its z axis, counter-clockwise, radians.
  Brush turned(double yaw) const {
    return in(
        {{std::cos(yaw), std::sin(yaw), 0}, {-std::sin(yaw), std::cos(yaw), 0}, {0, 0, 1}, {}});
  }
  /// The frame mapped by any affine map.
  Brush in(const Frame& frame) const;
  /// Another reflectivity, [0, 1].
  Brush of(double reflectivity) const;

  void box(const Vec3& low, const Vec3& high) const;
  void ellipsoid(const Vec3& centre, const Vec3& radii) const;
  /// A closed cylinder or cone stump between two points, either radius may be 0.
  void frustum(const Vec3& from, const Vec3& to, double radius_from, double radius_to) const;
  void cylinder(const Vec3& from, const Vec3& to, double radius) const {
    frustum(from, to, radius, radius);
  }
  /// Flat, seen from both sides. Triangles without area are left out.
  void triangle(const Vec3& a, const Vec3& b, const Vec3& c) const;
  void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  /// A box with an opening through it along y: `opening` in metres, x from the box's middle and
  /// z as the box's own.
  void panel(const Vec3& low, const Vec3& high, const Opening& opening) const;
  /// A mesh of (rows - 1) x (columns - 1) quads over `point(row, column)`.
  template <class Point>
  void sheet(int rows, int columns, const Point& point) const;

 private:
  void add(Shape shape, const Frame& local, double taper = 1, const Opening& opening = {}) const;

  Sketch* sketch_;
  Frame frame_;
  double reflectivity_ = 0.5;
};

template <class Point>
void Brush::sheet(int rows, int columns, const Point& point) const {
  std::vector<Vec3> last, next;
  for (int i = 0; i < rows; ++i) {
    next.clear();
    for (int j = 0; j < columns; ++j) next.push_back(point(i, j));
    for (std::size_t j = 0; i > 0 && j + 1 < next.size(); ++j) {
      quad(last[j], last[j + 1], next[j + 1], next[j]);
    }
    last.swap(next);
  }
}

}  // namespace curlidar::scenery
