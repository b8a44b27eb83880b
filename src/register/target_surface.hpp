// SPDX-License-Identifier: BSD-3-Clause
// Points that others are laid on, with the planes around them.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "curlidar/vec3.hpp"

namespace curlidar::registration {

inline constexpr std::uint32_t kNoTarget = std::numeric_limits<std::uint32_t>::max();

class TargetSurface {
 public:
  /// O(n log n).
  explicit TargetSurface(std::vector<Vec3> points);
  ~TargetSurface();

  const std::vector<Vec3>& points() const;
  /// The point nearest to `query` and nearer than `within`; kNoTarget if there is none. May be
  /// called from several threads.
  std::uint32_t nearest(const Vec3& query, double within_m) const;
  /// Makes planes at the points numbered, where there are none yet: each is seen when it is needed,
  /// since most never are. kNoTarget is passed over.
  void make_planes(std::span<const std::uint32_t> wanted, std::size_t threads);
  /// Unit normal of the plane at a point that make_planes was asked for; zero where its neighbours
  /// are no plane.
  const Vec3& normal(std::uint32_t point) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace curlidar::registration
