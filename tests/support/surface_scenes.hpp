// SPDX-License-Identifier: BSD-3-Clause
// Samples of simple surfaces within a tile, and distances from and to them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "curlidar/map_settings.hpp"
#include "curlidar/map_tile.hpp"
#include "map/tile_points.hpp"

namespace curlidar::test {

/// Numbers in [0, 1) without a pattern, the same everywhere.
inline double scattered(std::uint32_t k) {
  std::uint32_t x = k * 2654435761u + 12345u;
  x ^= x >> 15;
  x *= 2246822519u;
  x ^= x >> 13;
  return (x >> 8) / 16777216.0;
}

/// A slanted floor over the tile, with noise.
inline std::vector<MapSample> plane_samples(double side, double noise_m) {
  std::vector<MapSample> out;
  const auto n = static_cast<std::uint32_t>(side / 0.1);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const double x = (i + 0.5) * side / n, y = (j + 0.5) * side / n;
      const double off = noise_m * (scattered(i * n + j) - 0.5);
      out.push_back({{x, y, 0.7 + 0.05 * x - 0.02 * y + off}, 1, 0.5f});
    }
  }
  return out;
}

/// A room's floor and four walls, none along the axes' planes of the grid.
inline std::vector<MapSample> box_samples(double side) {
  std::vector<MapSample> out;
  const double low = 0.13 * side, high = 0.81 * side;
  for (std::uint32_t k = 0; k < 30000; ++k) {
    const double a = low + (high - low) * scattered(3 * k), b = scattered(3 * k + 1);
    const double tall = -1.3 + 3.2 * b, across = low + (high - low) * b;
    switch (k % 6) {
      case 0:
        out.push_back({{low, a, tall}, 1, 0.1f});
        break;
      case 1:
        out.push_back({{high, a, tall}, 1, 0.2f});
        break;
      case 2:
        out.push_back({{a, low, tall}, 1, 0.3f});
        break;
      case 3:
        out.push_back({{a, high, tall}, 1, 0.4f});
        break;
      default:
        out.push_back({{a, across, -1.3}, 2, 0.5f});
        break;
    }
  }
  return out;
}

inline std::vector<MapSample> sphere_samples(double side) {
  std::vector<MapSample> out;
  const double radius = 0.2 * side;
  for (std::uint32_t k = 0; k < 30000; ++k) {
    const double z = 2 * scattered(2 * k) - 1, turn = 2 * std::numbers::pi * scattered(2 * k + 1);
    const double r = std::sqrt(1 - z * z);
    out.push_back({{side / 2 + radius * r * std::cos(turn), side / 2 + radius * r * std::sin(turn),
                    1 + radius * z},
                   1,
                   0.5f});
  }
  return out;
}

/// From a point along each leaf's axis to its surface, where its footprint says so, upright; the
/// least over all leaves, at most `most`.
inline double distance_to(const MapTile& tile, const Vec3& p, double most) {
  const std::array<double, 3> at = {p.x, p.y, p.z};
  double least = most;
  for (const MapLeaf& leaf : tile.leaves) {
    const std::array<double, 3> centre = {leaf.centre.x, leaf.centre.y, leaf.centre.z};
    const std::size_t u = (leaf.axis + 1u) % 3, v = (leaf.axis + 2u) % 3;
    const double du = at[u] - centre[u], dv = at[v] - centre[v], half = leaf.size_m / 2;
    if (std::abs(du) > half || std::abs(dv) > half) continue;
    const auto place = [&](double d) {
      return std::min(static_cast<std::size_t>((d + half) / leaf.size_m * leaf.cells),
                      std::size_t{leaf.cells} - 1);
    };
    if (tile.footprint[leaf.first_cell + place(du) * leaf.cells + place(dv)] == 0) continue;
    const double a = leaf.slope[0], b = leaf.slope[1];
    const double off =
        std::abs(at[leaf.axis] - leaf_height(leaf, du, dv)) / std::sqrt(1 + a * a + b * b);
    least = std::min(least, off);
  }
  return least;
}

inline double distance_to(const std::vector<MapSample>& samples, const Vec3& p) {
  double least = 1e9;
  for (const MapSample& sample : samples) {
    const Vec3 d = sample.position - p;
    least = std::min(least, dot(d, d));
  }
  return std::sqrt(least);
}

}  // namespace curlidar::test
