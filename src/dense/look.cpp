// SPDX-License-Identifier: BSD-3-Clause
#include "dense/look.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace curlidar {
namespace {

/// Samples farther apart than so many columns have others missing between them.
constexpr double kNeighbours = 1.9;
/// Samples beside each other no farther apart, as a share of the nearer, are of one surface.
constexpr double kSameShare = 0.1, kSame_m = 0.3;
/// Radians. Samples farther apart, of few columns, have no straight line between them.
constexpr double kWidest = 1;

PlanePoint place_of(const RingPoint& p) {
  return {p.rho, p.z};
}

/// Where the straight line between two samples crosses the half-plane.
void mix(RingLook& look, double step) {
  const RingPoint &left = *look.left.point, &right = *look.right.point;
  const double to_left = left.rho * std::sin(look.left.away * step);
  const double to_right = right.rho * std::sin(look.right.away * step);
  const double across = to_left + to_right;
  const double share = across > 0 ? to_left / across : 0;
  const double far = (look.left.away + look.right.away) * step;
  look.place.rho = across > 0 ? left.rho * right.rho * std::sin(far) / across : left.rho;
  look.place.z = left.z + (right.z - left.z) * share;
  look.right_weight = share;
  look.mixed = true;
}

bool alike(double a, double b) {
  return std::abs(a - b) <= kSameShare * std::min(a, b) + kSame_m;
}

}  // namespace

double PlaneLine::inverse_to(const PlanePoint& a, const PlanePoint& b) const {
  const double wr = b.rho - a.rho, wz = b.z - a.z;
  const double behind = (a.rho - from.rho) * wz - (a.z - from.z) * wr;
  const double across = along.rho * wz - along.z * wr;
  return behind != 0 ? across / behind : 0;
}

double PlaneLine::distance(const PlanePoint& p) const {
  const double rho = p.rho - from.rho, z = p.z - from.z;
  return std::sqrt(rho * rho + z * z);
}

RingLook look_at_ring(const RingPoints& points, const PlaneLine& line, std::ptrdiff_t ring) {
  RingLook look;
  if (ring < 0 || ring >= static_cast<std::ptrdiff_t>(points.rings())) return look;
  const auto at = static_cast<std::size_t>(ring);
  look.ring = static_cast<std::int32_t>(ring);
  const auto [left, right] = points.around(at, line.azimuth);
  if (left.point == nullptr) {
    constexpr double kSomewhere_m = 20;
    const double elevation = points.elevations()[at];
    look.place = {kSomewhere_m * std::cos(elevation),
                  kSomewhere_m * std::sin(elevation) + points.height_m(at)};
    look.r = line.distance(look.place);
    return look;
  }
  look.left = left;
  look.right = right;
  look.near = std::min(left.away, right.away);
  look.known = look.near <= RingLook::kFill;
  const bool to_right = right.away < left.away;
  const bool both =
      std::max(left.away, right.away) <= RingLook::kFill || left.away + right.away <= kNeighbours;
  const bool wide = (left.away + right.away) * points.column_step() > kWidest;
  if (left.away > 0 && both && !wide && alike(left.point->rho, right.point->rho)) {
    mix(look, points.column_step());
  } else {
    look.place = place_of(to_right ? *right.point : *left.point);
    look.right_weight = to_right ? 1 : 0;
  }
  look.r = line.distance(look.place);
  return look;
}

Look look_along(const RingPoints& points, const PlaneLine& line) {
  Look look;
  look.line = line;
  const auto rings = static_cast<std::ptrdiff_t>(points.rings());
  const std::vector<double>& elevations = points.elevations();
  const double elevation = std::atan2(line.along.z, line.along.rho);
  // The first ring below, as the beams point; then as the samples are seen.
  std::ptrdiff_t below =
      std::upper_bound(elevations.begin(), elevations.end(), elevation, std::greater<>()) -
      elevations.begin();
  below = std::min(below, rings - 1);
  look.below = look_at_ring(points, line, below);
  while (line.side(look.below.place) > 0) {
    look.above = look.below;
    look.below = look_at_ring(points, line, ++below);
    if (look.below.ring < 0) break;
  }
  while (look.above.ring < 0 && below > 0) {
    look.above = look_at_ring(points, line, below - 1);
    if (line.side(look.above.place) > 0) break;
    look.below = look.above;
    look.above = {};
    --below;
  }
  look.above2 = look_at_ring(points, line, below - 2);
  look.below2 = look_at_ring(points, line, below + 1);
  if (look.above.ring >= 0 && look.below.ring >= 0) {
    const double up = line.side(look.above.place) / look.above.r;
    const double down = -line.side(look.below.place) / look.below.r;
    look.gap = up + down;
    look.share = look.gap > 0 ? down / look.gap : 0;
  }
  return look;
}

int Neighbours::count(int reach) const {
  int count = 0;
  for (int column = -reach; column <= reach; ++column) count += at(column) > 0 ? 1 : 0;
  return count;
}

Neighbours neighbours_of(const RingPoints& points, const PlaneLine& line, std::ptrdiff_t ring) {
  Neighbours found;
  if (ring < 0 || ring >= static_cast<std::ptrdiff_t>(points.rings())) return found;
  const auto at = static_cast<std::size_t>(ring);
  if (points.ring(at).empty()) return found;
  const std::size_t beyond = points.first_beyond(at, line.azimuth);
  const auto most = static_cast<std::ptrdiff_t>(points.ring(at).size());
  const auto take = [&](std::ptrdiff_t steps) {
    const RingPoint& p = points.walk(at, beyond, steps);
    const double away = turn_between(line.azimuth, p.azimuth) / points.column_step();
    const auto column = static_cast<int>(std::lround(away));
    if (std::abs(column) > Neighbours::kSide) return false;
    const auto place = static_cast<std::size_t>(column + Neighbours::kSide);
    found.r[place] = static_cast<float>(line.distance(place_of(p)));
    found.point[place] = &p;
    return true;
  };
  for (std::ptrdiff_t steps = 0; steps < std::min<std::ptrdiff_t>(most, 40) && take(steps);) {
    ++steps;
  }
  for (std::ptrdiff_t steps = 1; steps <= std::min<std::ptrdiff_t>(most, 40) && take(-steps);) {
    ++steps;
  }
  return found;
}

}  // namespace curlidar
