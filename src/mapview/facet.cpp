// SPDX-License-Identifier: BSD-3-Clause
#include "mapview/facet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace curlidar {
namespace {

using Place = std::array<double, 2>;

/// A convex polygon of u and v, counter-clockwise: a rectangle cut twice has at most six corners.
struct Polygon {
  std::array<Place, 8> corners;
  std::size_t size = 0;
  void add(const Place& place) { corners[size++] = place; }
};

double height_at(const Facet& facet, const Place& p) {
  return facet.height + facet.slope_u * p[0] + facet.slope_v * p[1];
}

/// What is left of the polygon where side * w <= reach.
Polygon cut(const Polygon& polygon, const Facet& facet, double side, double reach) {
  Polygon left;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Place& a = polygon.corners[i];
    const Place& b = polygon.corners[(i + 1) % polygon.size];
    const double over_a = side * height_at(facet, a) - reach;
    const double over_b = side * height_at(facet, b) - reach;
    if (over_a <= 0) left.add(a);
    if ((over_a < 0 && over_b > 0) || (over_a > 0 && over_b < 0)) {
      const double t = over_a / (over_a - over_b);
      left.add({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
    }
  }
  return left;
}

bool holds(const Polygon& polygon, const Place& p) {
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Place& a = polygon.corners[i];
    const Place& b = polygon.corners[(i + 1) % polygon.size];
    if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) < 0) return false;
  }
  return true;
}

double squared_distance(const Facet& facet, const Place& p, const std::array<double, 3>& point) {
  const double u = p[0] - point[0], v = p[1] - point[1], w = height_at(facet, p) - point[2];
  return u * u + v * v + w * w;
}

Place nearest_on_edge(const Facet& facet, const Place& a, const Place& b,
                      const std::array<double, 3>& point) {
  const double du = b[0] - a[0], dv = b[1] - a[1];
  const double dw = facet.slope_u * du + facet.slope_v * dv;
  const double length2 = du * du + dv * dv + dw * dw;
  if (!(length2 > 0)) return a;
  const double along =
      (point[0] - a[0]) * du + (point[1] - a[1]) * dv + (point[2] - height_at(facet, a)) * dw;
  const double t = std::clamp(along / length2, 0.0, 1.0);
  return {a[0] + t * du, a[1] + t * dv};
}

}  // namespace

std::optional<std::array<double, 2>> nearest_on_facet(const Facet& facet,
                                                      const Rectangle& rectangle, double reach,
                                                      const std::array<double, 3>& point) {
  Polygon polygon;
  polygon.add({rectangle.u0, rectangle.v0});
  polygon.add({rectangle.u1, rectangle.v0});
  polygon.add({rectangle.u1, rectangle.v1});
  polygon.add({rectangle.u0, rectangle.v1});
  double highest = 0;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    highest = std::max(highest, std::abs(height_at(facet, polygon.corners[i])));
  }
  if (highest > reach) polygon = cut(cut(polygon, facet, 1, reach), facet, -1, reach);
  if (polygon.size == 0) return std::nullopt;

  // The foot of the perpendicular.
  const double above =
      point[2] - facet.height - facet.slope_u * point[0] - facet.slope_v * point[1];
  const double share = above / (1 + facet.slope_u * facet.slope_u + facet.slope_v * facet.slope_v);
  const Place foot{point[0] + share * facet.slope_u, point[1] + share * facet.slope_v};
  if (polygon.size > 2 && holds(polygon, foot)) return foot;

  Place best{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Place place =
        nearest_on_edge(facet, polygon.corners[i], polygon.corners[(i + 1) % polygon.size], point);
    const double squared = squared_distance(facet, place, point);
    if (squared < least) least = squared, best = place;
  }
  return best;
}

}  // namespace curlidar
