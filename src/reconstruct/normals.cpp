// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/normals.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/parallel.hpp"
#include "reconstruct/surface.hpp"

namespace curlidar {
namespace {

/// Neighbours are looked for so far beside a point: less is noise, more is another surface.
constexpr double kBeside_m = 0.15;
/// ... but at these angles at least and at most, radians.
constexpr double kLeastAngle = 1e-3, kMostAngle = 0.05;
/// Roughness of what is still one surface.
constexpr double kRough_m = 0.05;

/// Two directions across a line of sight, of unit length.
struct Across {
  Vec3 left, up;
};

Across across(const Vec3& direction) {
  const double flat = std::hypot(direction.x, direction.y);
  const Vec3 left = flat > 0 ? Vec3{-direction.y / flat, direction.x / flat, 0} : Vec3{0, 1, 0};
  return {left, cross(direction, left)};
}

/// One axis across the line of sight to a point, and what lies beside the point on it.
struct Axis {
  std::size_t point = 0;  ///< its number
  Vec3 step;              ///< to the farther neighbours, added to the direction
  Vec3 before, behind;    ///< the farther neighbours
  Vec3 tangent = kNowherePoint;
};

/// The axes of all points that are returns, two of each.
std::vector<Axis> axes_of(std::span<const Vec3> points, std::size_t begin, std::size_t end) {
  std::vector<Axis> axes;
  for (std::size_t i = begin; i < end; ++i) {
    if (!is_return(points[i])) continue;
    const double range = norm(points[i]);
    const double angle = std::clamp(kBeside_m / range, kLeastAngle, kMostAngle);
    const Across both = across(points[i] * (1 / range));
    for (const Vec3& axis : {both.left, both.up}) {
      axes.push_back({.point = i, .step = axis * angle, .before = {}, .behind = {}});
    }
  }
  return axes;
}

/// Looks at both sides of the points, a share of the step away: two points for each axis.
std::vector<Vec3> look_beside(const ScanView& view, std::span<const Vec3> points,
                              std::span<const Axis> axes, double share) {
  std::vector<Sightline> lines(2 * axes.size());
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const Vec3& point = points[axes[k].point];
    const Vec3 direction = point * (1 / norm(point));
    lines[2 * k].direction = direction - axes[k].step * share;
    lines[2 * k + 1].direction = direction + axes[k].step * share;
  }
  std::vector<Vec3> beside(lines.size());
  std::vector<float> confidence(lines.size());
  view.look(lines, beside, confidence, 1);
  return beside;
}

/// Where a point is not on the straight line between its farther neighbours, the nearer ones tell
/// on which side its surface goes on.
void look_closer(const ScanView& view, std::span<const Vec3> points, std::vector<Axis>& axes) {
  std::vector<Axis> open;
  std::copy_if(axes.begin(), axes.end(), std::back_inserter(open),
               [](const Axis& axis) { return std::isnan(axis.tangent.x); });
  const std::vector<Vec3> near = look_beside(view, points, open, 0.5);
  std::size_t next = 0;
  for (Axis& axis : axes) {
    if (!std::isnan(axis.tangent.x)) continue;
    const Vec3 &point = points[axis.point], &left = near[next], &right = near[next + 1];
    next += 2;
    const bool before = is_straight(axis.before, left, point, kRough_m);
    const bool behind = is_straight(point, right, axis.behind, kRough_m);
    if (is_straight(left, point, right, kRough_m)) {
      axis.tangent = right - left;
    } else if (before != behind) {
      axis.tangent = before ? point - axis.before : axis.behind - point;
    }
  }
}

Vec3 normal_of(const Vec3& point, const Vec3& left, const Vec3& up) {
  const Vec3 normal = cross(left, up);
  const double length = norm(normal);
  if (!(length > 0)) return kNowherePoint;
  return normal * ((dot(normal, point) > 0 ? -1 : 1) / length);
}

}  // namespace

std::vector<Vec3> normals_at(const ScanView& view, std::span<const Vec3> points,
                             std::size_t threads) {
  constexpr std::size_t kChunk = 512;
  std::vector<Vec3> normals(points.size(), kNowherePoint);
  parallel_for((points.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    const std::size_t begin = chunk * kChunk, end = std::min(points.size(), begin + kChunk);
    std::vector<Axis> axes = axes_of(points, begin, end);
    const std::vector<Vec3> far = look_beside(view, points, axes, 1);
    for (std::size_t k = 0; k < axes.size(); ++k) {
      axes[k].before = far[2 * k];
      axes[k].behind = far[2 * k + 1];
      if (is_straight(axes[k].before, points[axes[k].point], axes[k].behind, kRough_m)) {
        axes[k].tangent = axes[k].behind - axes[k].before;
      }
    }
    look_closer(view, points, axes);
    for (std::size_t k = 0; k + 1 < axes.size(); k += 2) {
      const std::size_t i = axes[k].point;
      normals[i] = normal_of(points[i], axes[k].tangent, axes[k + 1].tangent);
    }
  });
  return normals;
}

}  // namespace curlidar
