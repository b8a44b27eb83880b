// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/primitive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace curlidar::scenery {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEdge = 1e-9;
/// Surfaces nearer than this to the start of a ray are the surface it starts on.
constexpr double kNear = 1e-9;

struct Ray {
  Vec3 origin, direction;
};

/// A stretch of a ray inside a convex body, with the body's outward normals at both ends.
struct Interval {
  double enter = -kInfinity, leave = kInfinity;
  Vec3 enter_normal{}, leave_normal{};

  bool empty() const { return enter > leave; }
  void make_empty() { enter = kInfinity, leave = -kInfinity; }
};

/// Cuts the stretch by low <= o + t d <= high, where `axis` is the coordinate's unit vector.
void clip_slab(Interval& interval, double o, double d, double low, double high, const Vec3& axis) {
  if (d == 0) {
    if (o < low || o > high) interval.make_empty();
    return;
  }
  double near = (low - o) / d;
  double far = (high - o) / d;
  const double sign = d > 0 ? 1 : -1;
  if (near > far) std::swap(near, far);
  if (near > interval.enter) interval.enter = near, interval.enter_normal = axis * -sign;
  if (far < interval.leave) interval.leave = far, interval.leave_normal = axis * sign;
}

Interval clip_block(const Ray& ray) {
  Interval interval;
  clip_slab(interval, ray.origin.x, ray.direction.x, -1, 1, {1, 0, 0});
  clip_slab(interval, ray.origin.y, ray.direction.y, -1, 1, {0, 1, 0});
  clip_slab(interval, ray.origin.z, ray.direction.z, -1, 1, {0, 0, 1});
  return interval;
}

/// The first end of the stretch that lies in (kNear, t_max).
bool first_end(const Interval& interval, double t_max, double& t, Vec3& normal) {
  if (interval.empty()) return false;
  const bool outside = interval.enter > kNear;
  t = outside ? interval.enter : interval.leave;
  normal = outside ? interval.enter_normal : interval.leave_normal;
  return t > kNear && t < t_max;
}

/// Roots of a t^2 + 2 b t + c = 0 in ascending order, without cancellation. False if none.
bool solve_quadratic(double a, double b, double c, double& first, double& second) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0 || a == 0) return false;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  first = q / a;
  second = q != 0 ? c / q : first;
  if (first > second) std::swap(first, second);
  return true;
}

bool intersect_ball(const Ray& ray, double t_max, double& t, Vec3& normal) {
  double first = 0, second = 0;
  if (!solve_quadratic(dot(ray.direction, ray.direction), dot(ray.origin, ray.direction),
                       dot(ray.origin, ray.origin) - 1, first, second)) {
    return false;
  }
  t = first > kNear ? first : second;
  normal = ray.origin + ray.direction * t;
  return t > kNear && t < t_max;
}

/// Every surface of a frustum is tried; the first met wins. Inside and outside need no telling.
bool intersect_frustum(const Ray& ray, double taper, double t_max, double& t, Vec3& normal) {
  const Vec3& o = ray.origin;
  const Vec3& d = ray.direction;
  t = t_max;
  const auto offer = [&](double candidate, const Vec3& candidate_normal) {
    if (candidate > kNear && candidate < t) t = candidate, normal = candidate_normal;
  };
  const double slope = taper - 1;
  const double radius = 1 + slope * o.z;  // at the start's height
  const double growth = slope * d.z;      // of the radius along the ray
  const double a = d.x * d.x + d.y * d.y - growth * growth;
  const double b = o.x * d.x + o.y * d.y - radius * growth;
  const double c = o.x * o.x + o.y * o.y - radius * radius;
  double roots[2] = {0, 0};
  if (solve_quadratic(a, b, c, roots[0], roots[1])) {
    for (const double root : roots) {
      const double z = o.z + root * d.z;
      if (z < 0 || z > 1) continue;
      const Vec3 p = o + d * root;
      offer(root, {p.x, p.y, -slope * (1 + slope * z)});
    }
  }
  if (d.z != 0) {
    for (const double z : {0.0, 1.0}) {
      const double root = (z - o.z) / d.z;
      const Vec3 p = o + d * root;
      const double rim = z == 0 ? 1 : taper;
      if (p.x * p.x + p.y * p.y <= rim * rim) offer(root, {0, 0, z == 0 ? -1.0 : 1.0});
    }
  }
  return t < t_max;
}

bool intersect_triangle(const Ray& ray, double t_max, double& t, Vec3& normal) {
  if (ray.direction.z == 0) return false;
  t = -ray.origin.z / ray.direction.z;
  const double x = ray.origin.x + t * ray.direction.x;
  const double y = ray.origin.y + t * ray.direction.y;
  normal = {0, 0, 1};
  return t > kNear && t < t_max && x >= -kEdge && y >= -kEdge && x + y <= 1 + kEdge;
}

/// The stretch of a ray inside the opening's rectangle.
Interval clip_rectangle(const Ray& ray, const Opening& opening) {
  Interval interval;
  clip_slab(interval, ray.origin.x, ray.direction.x, -opening.half_width, opening.half_width,
            {1, 0, 0});
  clip_slab(interval, ray.origin.z, ray.direction.z, opening.bottom, opening.spring, {0, 0, 1});
  return interval;
}

/// The stretch of a ray inside the opening's half ellipse.
Interval clip_arch(const Ray& ray, const Opening& opening) {
  Interval interval;
  const double ox = ray.origin.x / opening.half_width;
  const double dx = ray.direction.x / opening.half_width;
  const double oz = (ray.origin.z - opening.spring) / opening.rise;
  const double dz = ray.direction.z / opening.rise;
  const double a = dx * dx + dz * dz;
  const double c = ox * ox + oz * oz - 1;
  if (a > 0) {
    if (!solve_quadratic(a, ox * dx + oz * dz, c, interval.enter, interval.leave)) {
      interval.make_empty();
      return interval;
    }
  } else if (c > 0) {
    interval.make_empty();
    return interval;
  }
  const auto gradient = [&](double at) {
    return Vec3{(ox + at * dx) / opening.half_width, 0, (oz + at * dz) / opening.rise};
  };
  if (a > 0) {
    interval.enter_normal = gradient(interval.enter);
    interval.leave_normal = gradient(interval.leave);
  }
  clip_slab(interval, ray.origin.z, ray.direction.z, opening.spring, kInfinity, {0, 0, 1});
  return interval;
}

/// Rectangle and half ellipse together are convex, so that their stretches join into one.
Interval clip_opening(const Ray& ray, const Opening& opening) {
  const Interval rectangle = clip_rectangle(ray, opening);
  if (opening.rise <= 0) return rectangle;
  const Interval arch = clip_arch(ray, opening);
  if (rectangle.empty()) return arch;
  if (arch.empty()) return rectangle;
  Interval joined = rectangle.enter <= arch.enter ? rectangle : arch;
  const Interval& last = rectangle.leave >= arch.leave ? rectangle : arch;
  joined.leave = last.leave;
  joined.leave_normal = last.leave_normal;
  return joined;
}

bool intersect_panel(const Ray& ray, const Opening& opening, double t_max, double& t,
                     Vec3& normal) {
  const Interval solid = clip_block(ray);
  if (solid.empty()) return false;
  const Interval hole = clip_opening(ray, opening);
  const bool misses_hole = hole.empty() || hole.enter >= solid.leave || hole.leave <= solid.enter;
  if (misses_hole) return first_end(solid, t_max, t, normal);
  // The solid that is left lies before and behind the hole; either stretch may be empty.
  Interval before = solid;
  before.leave = hole.enter;
  before.leave_normal = hole.enter_normal * -1;
  if (before.enter < before.leave && before.leave > kNear) {
    return first_end(before, t_max, t, normal);
  }
  Interval behind = solid;
  behind.enter = hole.leave;
  behind.enter_normal = hole.leave_normal * -1;
  return behind.enter < behind.leave && first_end(behind, t_max, t, normal);
}

}  // namespace

Frame compose(const Frame& outer, const Frame& inner) {
  return {outer.vector(inner.axis_x), outer.vector(inner.axis_y), outer.vector(inner.axis_z),
          outer.point(inner.origin)};
}

Primitive make_primitive(Shape shape, const Frame& frame, double reflectivity) {
  // Rows of the inverse by cross products (Cramer's rule).
  const Vec3 yz = cross(frame.axis_y, frame.axis_z);
  const double scale = 1 / dot(frame.axis_x, yz);
  Primitive primitive;
  primitive.row_x = yz * scale;
  primitive.row_y = cross(frame.axis_z, frame.axis_x) * scale;
  primitive.row_z = cross(frame.axis_x, frame.axis_y) * scale;
  primitive.offset = Vec3{dot(primitive.row_x, frame.origin), dot(primitive.row_y, frame.origin),
                          dot(primitive.row_z, frame.origin)} *
                     -1.0;
  primitive.reflectivity = reflectivity;
  primitive.shape = shape;
  return primitive;
}

namespace {

Vec3 lowest(const Vec3& a, const Vec3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Vec3 highest(const Vec3& a, const Vec3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// Half extents of centre + a cos + b sin + c ..., the unit ball's image under the three axes.
Vec3 round_extent(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {std::hypot(a.x, b.x, c.x), std::hypot(a.y, b.y, c.y), std::hypot(a.z, b.z, c.z)};
}

}  // namespace

Bounds bounds_of(Shape shape, const Frame& frame, double taper) {
  const auto& [x, y, z, origin] = frame;
  switch (shape) {
    case Shape::ball: {
      const Vec3 half = round_extent(x, y, z);
      return {origin - half, origin + half};
    }
    case Shape::frustum: {
      const Vec3 half = round_extent(x, y, {});
      const Vec3 top = origin + z;
      return {lowest(origin - half, top - half * taper),
              highest(origin + half, top + half * taper)};
    }
    case Shape::triangle:
      return {lowest(origin, lowest(origin + x, origin + y)),
              highest(origin, highest(origin + x, origin + y))};
    case Shape::block:
    case Shape::panel:
      break;
  }
  const Vec3 half{std::abs(x.x) + std::abs(y.x) + std::abs(z.x),
                  std::abs(x.y) + std::abs(y.y) + std::abs(z.y),
                  std::abs(x.z) + std::abs(y.z) + std::abs(z.z)};
  return {origin - half, origin + half};
}

bool intersect(const Primitive& primitive, const Vec3& origin, const Vec3& direction, double t_max,
               double& t, Vec3& normal) {
  const auto& [row_x, row_y, row_z, offset, opening, taper, reflectivity, shape] = primitive;
  const Ray ray{Vec3{dot(row_x, origin), dot(row_y, origin), dot(row_z, origin)} + offset,
                {dot(row_x, direction), dot(row_y, direction), dot(row_z, direction)}};
  Vec3 local{};
  bool met = false;
  switch (shape) {
    case Shape::ball:
      met = intersect_ball(ray, t_max, t, local);
      break;
    case Shape::block:
      met = first_end(clip_block(ray), t_max, t, local);
      break;
    case Shape::frustum:
      met = intersect_frustum(ray, taper, t_max, t, local);
      break;
    case Shape::triangle:
      met = intersect_triangle(ray, t_max, t, local);
      break;
    case Shape::panel:
      met = intersect_panel(ray, opening, t_max, t, local);
      break;
  }
  // Normals transform with the transposed inverse of the shape's map: the stored rows.
  if (met) normal = row_x * local.x + row_y * local.y + row_z * local.z;
  return met;
}

}  // namespace curlidar::scenery
