// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/world.hpp"

#include <limits>
#include <utility>

namespace curlidar::scenery {

World::World(Sketch sketch) : bvh_(sketch.bounds) {
  primitives_.reserve(sketch.primitives.size());
  for (const std::uint32_t i : bvh_.order()) primitives_.push_back(sketch.primitives[i]);
}

bool World::cast(const Vec3& origin, const Vec3& direction, Hit& hit) const {
  const Primitive* met = nullptr;
  double range = std::numeric_limits<double>::infinity();
  Vec3 met_normal{};
  bvh_.traverse(origin, direction, range, [&](std::uint32_t i, double& t_max) {
    double t = 0;
    Vec3 normal{};
    if (!intersect(primitives_[i], origin, direction, t_max, t, normal)) return;
    t_max = range = t;
    met = &primitives_[i];
    met_normal = normal;
  });
  if (met == nullptr) return false;
  hit.moving = false;
  hit.range_m = range;
  hit.reflectivity = met->reflectivity;
  const double length = norm(met_normal);
  hit.cos_incidence = length > 0 ? std::abs(dot(met_normal, direction)) / length : 1;
  return true;
}

Brush Brush::in(const Frame& frame) const {
  Brush brush = *this;
  brush.frame_ = compose(frame_, frame);
  return brush;
}

Brush Brush::of(double reflectivity) const {
  Brush brush = *this;
  brush.reflectivity_ = reflectivity;
  return brush;
}

void Brush::box(const Vec3& low, const Vec3& high) const {
  const Vec3 half = (high - low) * 0.5;
  add(Shape::block, {{half.x, 0, 0}, {0, half.y, 0}, {0, 0, half.z}, (low + high) * 0.5});
}

void Brush::ellipsoid(const Vec3& centre, const Vec3& radii) const {
  add(Shape::ball, {{radii.x, 0, 0}, {0, radii.y, 0}, {0, 0, radii.z}, centre});
}

void Brush::frustum(const Vec3& from, const Vec3& to, double radius_from, double radius_to) const {
  if (radius_from < radius_to) return frustum(to, from, radius_to, radius_from);
  const Vec3 axis = to - from;
  const double length = norm(axis);
  const Vec3 w = axis * (1 / length);
  const Vec3 helper = std::abs(w.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 across = cross(helper, w);
  const Vec3 u = across * (1 / norm(across));
  add(Shape::frustum, {u * radius_from, cross(w, u) * radius_from, axis, from},
      radius_to / radius_from);
}

void Brush::triangle(const Vec3& a, const Vec3& b, const Vec3& c) const {
  const Vec3 normal = cross(b - a, c - a);
  const double area = norm(normal);
  if (area < 1e-12) return;
  add(Shape::triangle, {b - a, c - a, normal * (1 / area), a});
}

void Brush::panel(const Vec3& low, const Vec3& high, const Opening& opening) const {
  const Vec3 half = (high - low) * 0.5;
  const Vec3 middle = (low + high) * 0.5;
  add(Shape::panel, {{half.x, 0, 0}, {0, half.y, 0}, {0, 0, half.z}, middle}, 1,
      {opening.half_width / half.x, (opening.bottom - middle.z) / half.z,
       (opening.spring - middle.z) / half.z, opening.rise / half.z});
}

void Brush::add(Shape shape, const Frame& local, double taper, const Opening& opening) const {
  const Frame world = compose(frame_, local);
  Primitive primitive = make_primitive(shape, world, reflectivity_);
  primitive.taper = taper;
  primitive.opening = opening;
  sketch_->primitives.push_back(primitive);
  sketch_->bounds.push_back(bounds_of(shape, world, taper));
}

}  // namespace curlidar::scenery
