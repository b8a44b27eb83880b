// SPDX-License-Identifier: BSD-3-Clause
#include "mapview/leaf_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "map/tile_points.hpp"
#include "mapview/facet.hpp"

namespace curlidar {
namespace {

/// Between two leaves no line is lost to rounding.
constexpr double kRounding_m = 1e-6;
/// Along each side of a cell.
constexpr int kCurvedParts = 4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Roots of a t^2 + b t + c, ascending; NaN or infinite where there is none.
std::array<double, 2> roots(double a, double b, double c) {
  if (a == 0) return {-c / b, kInfinity};
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return {kInfinity, kInfinity};
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  const double first = q / a, second = c / q;
  return first < second ? std::array{first, second} : std::array{second, first};
}

struct Interval {
  double low, high;
};
Interval operator*(double s, const Interval& x) {
  return s < 0 ? Interval{s * x.high, s * x.low} : Interval{s * x.low, s * x.high};
}
Interval operator+(const Interval& a, const Interval& b) {
  return {a.low + b.low, a.high + b.high};
}
Interval product(const Interval& a, const Interval& b) {
  const auto [low, high] =
      std::minmax({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
  return {low, high};
}

}  // namespace

LeafShape::LeafShape(const MapTile& tile, const MapLeaf& leaf, const Vec3& shift, double gap_cells)
    : centre_(in_leaf_frame(leaf.axis, leaf.centre + shift)),
      half_m_(leaf.size_m / 2),
      cell_m_(leaf.size_m / leaf.cells),
      gap_m_(std::max(gap_cells * cell_m_, kRounding_m)),
      height_m_(leaf.height_m - in_leaf_frame(leaf.axis, leaf.centre)[2]),
      slope_(leaf.slope),
      curve_(leaf.curve),
      footprint_(tile.footprint.data() + leaf.first_cell),
      cells_(leaf.cells),
      intensity_(leaf.intensity),
      axis_(leaf.axis),
      curved_(leaf.curve != std::array<double, 3>{}) {}

bool LeafShape::seen(std::int64_t i, std::int64_t j) const {
  return i >= 0 && j >= 0 && i < cells_ && j < cells_ && footprint_[i * cells_ + j] != 0;
}

std::int64_t LeafShape::cell_of(double x) const {
  const double index = std::floor((x + half_m_) / cell_m_);
  return static_cast<std::int64_t>(std::clamp(index, 0.0, static_cast<double>(cells_ - 1)));
}

double LeafShape::height(double u, double v) const {
  return height_m_ + slope_[0] * u + slope_[1] * v + curve_[0] * u * u + curve_[1] * u * v +
         curve_[2] * v * v;
}

std::array<double, 2> LeafShape::slope(double u, double v) const {
  return {slope_[0] + 2 * curve_[0] * u + curve_[1] * v,
          slope_[1] + curve_[1] * u + 2 * curve_[2] * v};
}

std::optional<Bounds> LeafShape::bounds() const {
  std::int64_t i0 = cells_, i1 = -1, j0 = cells_, j1 = -1;
  for (std::int64_t i = 0; i < cells_; ++i) {
    for (std::int64_t j = 0; j < cells_; ++j) {
      if (!seen(i, j)) continue;
      i0 = std::min(i0, i), i1 = std::max(i1, i);
      j0 = std::min(j0, j), j1 = std::max(j1, j);
    }
  }
  if (i1 < 0) return std::nullopt;
  const auto edge = [&](std::int64_t i) { return static_cast<double>(i) * cell_m_ - half_m_; };
  const Interval u{edge(i0) - gap_m_, edge(i1 + 1) + gap_m_};
  const Interval v{edge(j0) - gap_m_, edge(j1 + 1) + gap_m_};
  Interval w = Interval{height_m_, height_m_} + slope_[0] * u + slope_[1] * v +
               curve_[0] * product(u, u) + curve_[1] * product(u, v) + curve_[2] * product(v, v);
  const double reach = half_m_ + kLeafSlack_m + gap_m_;
  w = {std::max(w.low, -reach), std::min(w.high, reach)};
  if (w.low > w.high) return std::nullopt;
  const LeafFrame low{centre_[0] + u.low, centre_[1] + v.low, centre_[2] + w.low};
  const LeafFrame high{centre_[0] + u.high, centre_[1] + v.high, centre_[2] + w.high};
  return Bounds{out_of_leaf_frame(axis_, low), out_of_leaf_frame(axis_, high)};
}

/// Within the gap of a cell that was seen.
bool LeafShape::near_footprint(double u, double v) const {
  for (std::int64_t i = cell_of(u - gap_m_); i <= cell_of(u + gap_m_); ++i) {
    for (std::int64_t j = cell_of(v - gap_m_); j <= cell_of(v + gap_m_); ++j) {
      if (seen(i, j)) return true;
    }
  }
  return false;
}

LeafCrossing LeafShape::cross(const Vec3& origin, const Vec3& direction, double t_max) const {
  LeafCrossing crossing{kInfinity, kInfinity};
  const LeafFrame o = in_leaf_frame(axis_, origin), d = in_leaf_frame(axis_, direction);
  const double u = o[0] - centre_[0], v = o[1] - centre_[1], w = o[2] - centre_[2];
  const auto [su, sv] = slope(u, v);
  const double c = w - height(u, v);
  const double b = d[2] - su * d[0] - sv * d[1];
  const double a = -(curve_[0] * d[0] * d[0] + curve_[1] * d[0] * d[1] + curve_[2] * d[1] * d[1]);
  const double reach = half_m_ + kLeafSlack_m;
  for (const double t : roots(a, b, c)) {
    if (!(t > 0 && t < t_max)) continue;
    const double at_u = u + t * d[0], at_v = v + t * d[1], off = std::abs(w + t * d[2]);
    const double side = std::max(std::abs(at_u), std::abs(at_v));
    if (side > half_m_ + gap_m_ || off > reach + gap_m_) continue;
    if (off <= reach && side <= half_m_ + kRounding_m && seen(cell_of(at_u), cell_of(at_v))) {
      crossing.surface = t;
      return crossing;
    }
    if (crossing.margin == kInfinity && near_footprint(at_u, at_v)) crossing.margin = t;
  }
  return crossing;
}

Vec3 LeafShape::normal(const Vec3& point) const {
  const LeafFrame p = in_leaf_frame(axis_, point);
  const auto [su, sv] = slope(p[0] - centre_[0], p[1] - centre_[1]);
  const double length = std::sqrt(1 + su * su + sv * sv);
  return out_of_leaf_frame(axis_, {-su / length, -sv / length, 1 / length});
}

/// Curved cells in parts, each by its tangent plane: Newton's method would not find the nearest
/// place of surfaces that bend towards or away from a far point.
double LeafShape::cell_distance(const Cell& cell, const LeafFrame& point) const {
  const int parts = curved_ ? kCurvedParts : 1;
  const double reach = half_m_ + kLeafSlack_m, part = cell_m_ / parts;
  double best = kInfinity;
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; j < parts; ++j) {
      const double u0 = cell.u0 + i * part, v0 = cell.v0 + j * part;
      const double u = u0 + part / 2, v = v0 + part / 2;
      const auto [su, sv] = slope(u, v);
      const Facet facet{height(u, v) - su * u - sv * v, su, sv};
      const auto nearest = nearest_on_facet(facet, {u0, u0 + part, v0, v0 + part}, reach, point);
      if (!nearest) continue;
      const double du = point[0] - (*nearest)[0], dv = point[1] - (*nearest)[1];
      const double dw = point[2] - height((*nearest)[0], (*nearest)[1]);
      best = std::min(best, std::sqrt(du * du + dv * dv + dw * dw));
    }
  }
  return best;
}

double LeafShape::distance(const Vec3& point, double reach) const {
  LeafFrame p = in_leaf_frame(axis_, point);
  for (std::size_t axis = 0; axis < 3; ++axis) p[axis] -= centre_[axis];
  // A cell is at least as far as its rectangle is along u and v.
  const auto edge = [&](std::int64_t i) { return static_cast<double>(i) * cell_m_ - half_m_; };
  for (std::int64_t i = cell_of(p[0] - reach); i <= cell_of(p[0] + reach); ++i) {
    for (std::int64_t j = cell_of(p[1] - reach); j <= cell_of(p[1] + reach); ++j) {
      if (!seen(i, j)) continue;
      const Cell at{edge(i), edge(i + 1), edge(j), edge(j + 1)};
      const double du = std::max({at.u0 - p[0], p[0] - at.u1, 0.0});
      const double dv = std::max({at.v0 - p[1], p[1] - at.v1, 0.0});
      if (du * du + dv * dv < reach * reach) reach = std::min(reach, cell_distance(at, p));
    }
  }
  return reach;
}

}  // namespace curlidar
