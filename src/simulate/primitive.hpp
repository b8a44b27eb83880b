// SPDX-License-Identifier: BSD-3-Clause
// Unit shapes under affine maps, and where a ray first meets them.
#pragma once

#include <cstdint>

#include "base/bvh.hpp"
#include "curlidar/vec3.hpp"

namespace curlidar::scenery {

/// An affine map: local (x, y, z) -> origin + x * axis_x + y * axis_y + z * axis_z.
struct Frame {
  Vec3 axis_x{1, 0, 0}, axis_y{0, 1, 0}, axis_z{0, 0, 1};
  Vec3 origin{};

  Vec3 vector(const Vec3& v) const { return axis_x * v.x + axis_y * v.y + axis_z * v.z; }
  Vec3 point(const Vec3& p) const { return origin + vector(p); }
};

/// `outer` after `inner`.
Frame compose(const Frame& outer, const Frame& inner);

enum class Shape : std::uint8_t {
  ball,      ///< x^2 + y^2 + z^2 <= 1; the map makes ellipsoids
  block,     ///< [-1, 1]^3; the map makes boxes at any angle
  frustum,   ///< 0 <= z <= 1, radius 1 at z = 0 and `taper` at z = 1, closed at both ends
  triangle,  ///< x >= 0, y >= 0, x + y <= 1 in the plane z = 0
  panel,     ///< a block with an opening cut through it along y
};

/// The opening of a panel, in the panel's own coordinates, centred on x = 0: a rectangle
/// |x| <= half_width, bottom <= z <= spring, under half an ellipse of height `rise` (0: none).
struct Opening {
  double half_width = 0.5, bottom = -2, spring = 0.5, rise = 0;
};

/// A shape in the world. Built by `make_primitive`; stores the map from the world to the shape.
struct Primitive {
  Vec3 row_x, row_y, row_z;  ///< rows of the linear part of world -> local
  Vec3 offset;               ///< its translation
  Opening opening;           ///< of a panel
  double taper = 1;          ///< of a frustum
  double reflectivity = 0.5;
  Shape shape = Shape::block;
};

/// The shape with local coordinates mapped to the world by `frame`, whose axes must be linearly
/// independent (for triangles, too: axis_z is then the plane's normal).
Primitive make_primitive(Shape shape, const Frame& frame, double reflectivity);

/// Bounds of the shape that `make_primitive` would build.
Bounds bounds_of(Shape shape, const Frame& frame, double taper);

/// First surface of the primitive with 0 < t < t_max along origin + t * direction. On success `t`
/// and the (unnormalised) world normal are set. A ray that starts inside a solid meets its far
/// side. Edges belong to the shape, widened by 1e-9 of its size so that meshes have no gaps.
bool intersect(const Primitive& primitive, const Vec3& origin, const Vec3& direction, double t_max,
               double& t, Vec3& normal);

}  // namespace curlidar::scenery
