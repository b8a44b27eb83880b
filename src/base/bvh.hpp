// SPDX-License-Identifier: BSD-3-Clause
// A bounding volume hierarchy: which few of many primitives may a ray meet, or lie near a point.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "curlidar/vec3.hpp"

namespace curlidar {

/// Axis-aligned bounds.
struct Bounds {
  Vec3 low, high;
};

/// Binary tree of axis-aligned boxes, split by the surface area heuristic in 16 bins.
class Bvh {
 public:
  Bvh() = default;
  /// O(n log n).
  explicit Bvh(std::span<const Bounds> bounds);

  /// The primitives in the order of the leaves: order()[i] is the index of the i-th.
  const std::vector<std::uint32_t>& order() const { return order_; }

  /// Calls visit(i, t_max) for the primitives (numbered in leaf order) whose boxes the ray meets
  /// before t_max, roughly near ones first; visit may lower t_max.
  template <class Visit>
  void traverse(const Vec3& origin, const Vec3& direction, double t_max, const Visit& visit) const;
  /// Calls visit(i, reach) for the primitives whose boxes are nearer to the point than `reach`,
  /// near ones first; visit may lower reach.
  template <class Visit>
  void around(const Vec3& point, double reach, const Visit& visit) const;

 private:
  struct Node {
    std::array<float, 6> bounds{};  ///< low x, y, z, high x, y, z, rounded outwards
    std::uint32_t first = 0;        ///< leaf: first primitive; inner: first of two children
    std::uint32_t count = 0;        ///< primitives of a leaf; 0 for an inner node
  };
  struct Range;
  struct Slabs {
    Slabs(const Vec3& origin, const Vec3& direction);
    std::array<double, 3> start, inverse;
    std::array<std::uint8_t, 3> near, far;  ///< which bound a ray of this direction meets first
    double enter(const Node& node, double t_max) const;
  };

  struct Pending {
    std::uint32_t node;
    double distance;  ///< along the ray, or from the point
  };

  static constexpr int kMaxDepth = 60;

  static double distance(const Node& node, const std::array<double, 3>& point);
  void build(std::uint32_t node, const Range& range, std::span<const Bounds> bounds);
  std::uint32_t split(const Range& range, std::span<const Bounds> bounds);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

inline Bvh::Slabs::Slabs(const Vec3& origin, const Vec3& direction)
    : start{origin.x, origin.y, origin.z} {
  const std::array<double, 3> d{direction.x, direction.y, direction.z};
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    // A huge finite inverse instead of infinity keeps 0 * inverse from being NaN.
    inverse[axis] = d[axis] != 0 ? 1 / d[axis] : 1e300;
    near[axis] = static_cast<std::uint8_t>(inverse[axis] > 0 ? axis : axis + 3);
    far[axis] = static_cast<std::uint8_t>(inverse[axis] > 0 ? axis + 3 : axis);
  }
}

/// Where the ray enters the node's box, or infinity if it does not before t_max.
inline double Bvh::Slabs::enter(const Node& node, double t_max) const {
  double first = 0, last = t_max;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first = std::max(first, (node.bounds[near[axis]] - start[axis]) * inverse[axis]);
    last = std::min(last, (node.bounds[far[axis]] - start[axis]) * inverse[axis]);
  }
  return first <= last ? first : std::numeric_limits<double>::infinity();
}

template <class Visit>
void Bvh::traverse(const Vec3& origin, const Vec3& direction, double t_max,
                   const Visit& visit) const {
  if (nodes_.empty()) return;
  const Slabs slabs(origin, direction);
  std::array<Pending, kMaxDepth + 4> stack;
  std::size_t size = 0;
  const double root = slabs.enter(nodes_[0], t_max);
  if (root < t_max) stack[size++] = {0, root};
  while (size > 0) {
    const Pending pending = stack[--size];
    if (pending.distance >= t_max) continue;
    const Node& node = nodes_[pending.node];
    if (node.count > 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) visit(node.first + i, t_max);
      continue;
    }
    Pending near{node.first, slabs.enter(nodes_[node.first], t_max)};
    Pending far{node.first + 1, slabs.enter(nodes_[node.first + 1], t_max)};
    if (near.distance > far.distance) std::swap(near, far);
    if (far.distance < t_max) stack[size++] = far;
    if (near.distance < t_max) stack[size++] = near;
  }
}

/// From the point to the node's box.
inline double Bvh::distance(const Node& node, const std::array<double, 3>& point) {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double outside =
        std::max({node.bounds[axis] - point[axis], point[axis] - node.bounds[axis + 3], 0.0});
    squared += outside * outside;
  }
  return std::sqrt(squared);
}

template <class Visit>
void Bvh::around(const Vec3& point, double reach, const Visit& visit) const {
  if (nodes_.empty()) return;
  const std::array<double, 3> p{point.x, point.y, point.z};
  std::array<Pending, kMaxDepth + 4> stack;
  std::size_t size = 0;
  stack[size++] = {0, distance(nodes_[0], p)};
  while (size > 0) {
    const Pending pending = stack[--size];
    if (pending.distance >= reach) continue;
    const Node& node = nodes_[pending.node];
    if (node.count > 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) visit(node.first + i, reach);
      continue;
    }
    Pending first{node.first, distance(nodes_[node.first], p)};
    Pending second{node.first + 1, distance(nodes_[node.first + 1], p)};
    if (first.distance > second.distance) std::swap(first, second);
    stack[size++] = second;
    stack[size++] = first;
  }
}

}  // namespace curlidar
