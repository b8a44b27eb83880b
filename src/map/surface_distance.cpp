// SPDX-License-Identifier: BSD-3-Clause
#include "map/surface_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "map/tile_points.hpp"

namespace curlidar::tile {
namespace {

double along(const Vec3& p, std::size_t axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

std::int64_t number(double value, double edge_m) {
  return static_cast<std::int64_t>(std::floor(value / edge_m));
}

std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  return (static_cast<std::uint64_t>(x) & kMask) << 42 |
         (static_cast<std::uint64_t>(y) & kMask) << 21 | (static_cast<std::uint64_t>(z) & kMask);
}

}  // namespace

SurfaceDistance::SurfaceDistance(const MapTile& surface, double most_m)
    : surface_(surface), most_m_(most_m) {
  for (std::size_t i = 0; i < surface.leaves.size(); ++i) {
    const MapLeaf& leaf = surface.leaves[i];
    Size& size = sizes_[leaf.size_m];
    // No smaller than a leaf: it reaches into few.
    size.edge_m = leaf.size_m + most_m;
    std::array<std::int64_t, 3> low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double reach = leaf.size_m / 2 + most_m;
      low[k] = number(along(leaf.centre, k) - reach, size.edge_m);
      high[k] = number(along(leaf.centre, k) + reach, size.edge_m);
    }
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          size.leaves[key(x, y, z)].push_back(static_cast<std::uint32_t>(i));
        }
      }
    }
  }
}

double SurfaceDistance::of(const Vec3& p) const {
  double least = most_m_;
  for (const auto& [edge, size] : sizes_) {
    const auto found = size.leaves.find(
        key(number(p.x, size.edge_m), number(p.y, size.edge_m), number(p.z, size.edge_m)));
    if (found == size.leaves.end()) continue;
    for (const std::uint32_t leaf : found->second) {
      least = std::min(least, of(surface_.leaves[leaf], p, least));
    }
  }
  return least;
}

double SurfaceDistance::of(const MapLeaf& leaf, const Vec3& p, double most_m) const {
  const double half = leaf.size_m / 2;
  const Vec3 d = p - leaf.centre;
  const double du = along(d, (leaf.axis + 1u) % 3), dv = along(d, (leaf.axis + 2u) % 3);
  const double reach = half + most_m;
  if (std::abs(du) > reach || std::abs(dv) > reach) return most_m;
  if (std::abs(along(d, leaf.axis)) > reach + 0.05) return most_m;
  const double cell = leaf.size_m / leaf.cells;
  const auto last = static_cast<double>(leaf.cells - 1);
  const auto cell_of = [&](double value) {
    return static_cast<std::size_t>(std::clamp(std::floor((value + half) / cell), 0.0, last));
  };
  double least = most_m;
  const auto ask = [&](std::size_t i, std::size_t j) {
    if (surface_.footprint[leaf.first_cell + i * leaf.cells + j] == 0) return;
    const double low_u = static_cast<double>(i) * cell - half;
    const double low_v = static_cast<double>(j) * cell - half;
    const double u = std::clamp(du, low_u, low_u + cell), v = std::clamp(dv, low_v, low_v + cell);
    const double su = leaf.slope[0] + 2 * leaf.curve[0] * u + leaf.curve[1] * v;
    const double sv = leaf.slope[1] + leaf.curve[1] * u + 2 * leaf.curve[2] * v;
    const double off = along(p, leaf.axis) - leaf_height(leaf, u, v);
    const double across = off * off / (1 + su * su + sv * sv);
    const double beside = (du - u) * (du - u) + (dv - v) * (dv - v);
    least = std::min(least, std::sqrt(across + beside));
  };
  // What lies under the point leaves less to look for around it.
  ask(cell_of(du), cell_of(dv));
  const double around = least;
  for (std::size_t i = cell_of(du - around); i <= cell_of(du + around); ++i) {
    for (std::size_t j = cell_of(dv - around); j <= cell_of(dv + around); ++j) ask(i, j);
  }
  return least;
}

}  // namespace curlidar::tile
