// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.hpp"
#include "reconstruct/surface.hpp"

namespace curlidar {
namespace {

/// Neighbours are looked for so far beside a point: less is noise, more is another surface.
constexpr double kBeside_m = 0.15;
/// ... but at these angles at least and at most, radians.
constexpr double kLeastAngle = 1e-3, kMostAngle = 0.05;
/// Neighbours of a point: left, half left, half right, right, then the same from below upwards.
constexpr std::size_t kNeighbours = 8;

/// Two directions across a line of sight, of unit length.
struct Across {
  Vec3 left, up;
};

Across across(const Vec3& direction) {
  const double flat = std::hypot(direction.x, direction.y);
  const Vec3 left = flat > 0 ? Vec3{-direction.y / flat, direction.x / flat, 0} : Vec3{0, 1, 0};
  return {left, cross(direction, left)};
}

void aim_beside(const Vec3& point, std::span<Sightline> lines) {
  constexpr std::array<double, 4> kSteps{-1, -0.5, 0.5, 1};
  const double range = norm(point);
  const Vec3 direction = point * (1 / range);
  const Across axes = across(direction);
  const double angle = std::clamp(kBeside_m / range, kLeastAngle, kMostAngle);
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    const Vec3& axis = i < kSteps.size() ? axes.left : axes.up;
    lines[i].direction = direction + axis * (angle * kSteps[i % kSteps.size()]);
  }
}

/// A tangent of the surface through `point` from its four neighbours along one axis; NaN if none
/// of them is on the same surface.
Vec3 tangent(const Vec3& point, std::span<const Vec3> beside) {
  const bool before = is_straight(beside[0], beside[1], point);
  const bool behind = is_straight(point, beside[2], beside[3]);
  if (before && behind && is_straight(beside[0], point, beside[3])) return beside[3] - beside[0];
  if (is_straight(beside[1], point, beside[2])) return beside[2] - beside[1];
  if (before != behind) return before ? point - beside[0] : beside[3] - point;
  return kNoPoint;
}

Vec3 normal_of(const Vec3& point, std::span<const Vec3> beside) {
  const Vec3 normal =
      cross(tangent(point, beside.subspan(0, 4)), tangent(point, beside.subspan(4)));
  const double length = norm(normal);
  if (!(length > 0)) return kNoPoint;
  return normal * ((dot(normal, point) > 0 ? -1 : 1) / length);
}

}  // namespace

std::vector<Vec3> normals_at(const View& view, std::span<const Vec3> points, std::size_t threads) {
  constexpr std::size_t kChunk = 512;
  std::vector<Vec3> normals(points.size(), kNoPoint);
  parallel_for((points.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    const std::size_t begin = chunk * kChunk, end = std::min(points.size(), begin + kChunk);
    std::vector<std::size_t> wanted;
    for (std::size_t i = begin; i < end; ++i) {
      if (is_return(points[i])) wanted.push_back(i);
    }
    std::vector<Sightline> lines(wanted.size() * kNeighbours);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      aim_beside(points[wanted[k]], std::span(lines).subspan(k * kNeighbours, kNeighbours));
    }
    std::vector<Vec3> beside(lines.size());
    std::vector<float> confidence(lines.size());
    view.look(lines, beside, confidence, 1);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      normals[wanted[k]] = normal_of(
          points[wanted[k]], std::span<const Vec3>(beside).subspan(k * kNeighbours, kNeighbours));
    }
  });
  return normals;
}

}  // namespace curlidar
