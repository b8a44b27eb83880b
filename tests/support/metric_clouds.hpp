// SPDX-License-Identifier: BSD-3-Clause
// Clouds for tests of distances and metrics, and the slow way to measure them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar::test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();

inline Cloud cloud_of(std::vector<Vec3> positions) {
  Cloud cloud;
  cloud.positions = std::move(positions);
  cloud.width = static_cast<std::uint32_t>(cloud.positions.size());
  return cloud;
}

/// Coordinates on a grid of `step` metres, so that exact ties and duplicates are common.
inline Cloud random_cloud(std::size_t size, std::uint32_t seed, double step) {
  std::mt19937 engine(seed);
  const auto coordinate = [&] { return (static_cast<double>(engine() % 200) - 100) * step; };
  std::vector<Vec3> positions(size);
  for (Vec3& p : positions) p = {coordinate(), coordinate(), coordinate() * 0.1};
  return cloud_of(std::move(positions));
}

/// The same with slots without a return among the others, and points that come twice.
inline Cloud holey_cloud(std::size_t size, std::uint32_t seed, double step) {
  Cloud cloud = random_cloud(size, seed, step);
  for (std::size_t i = 0; i < size; ++i) {
    if (i % 7 == 3) cloud.positions[i] = {0, 0, 0};
    if (i % 11 == 5) cloud.positions[i].y = kNan;
    if (i % 5 == 4) cloud.positions[i] = cloud.positions[i - 4];
  }
  return cloud;
}

/// Slots of the returns in the order of their distance to p, then of their number.
inline std::vector<std::size_t> returns_by_distance(const Cloud& cloud, const Vec3& p) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3 d = cloud.positions[i] - p;
    if (is_return(cloud.positions[i])) order.emplace_back(dot(d, d), i);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> slots;
  for (const auto& entry : order) slots.push_back(entry.second);
  return slots;
}

/// The first of the nearest returns of `to` for every slot of `from`; to.size() where there is
/// none.
inline std::vector<std::size_t> nearest_slots(const Cloud& from, const Cloud& to) {
  std::vector<std::size_t> slots(from.size(), to.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!is_return(from.positions[i])) continue;
    double best = kInf;
    for (std::size_t k = 0; k < to.size(); ++k) {
      const Vec3 d = from.positions[i] - to.positions[k];
      if (!is_return(to.positions[k]) || dot(d, d) >= best) continue;
      best = dot(d, d);
      slots[i] = k;
    }
  }
  return slots;
}

/// Distances to them; NaN where there is none.
inline std::vector<double> brute_force(const Cloud& from, const Cloud& to) {
  const std::vector<std::size_t> nearest = nearest_slots(from, to);
  std::vector<double> distances(from.size(), kNan);
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (nearest[i] < to.size()) distances[i] = norm(from.positions[i] - to.positions[nearest[i]]);
  }
  return distances;
}

}  // namespace curlidar::test
