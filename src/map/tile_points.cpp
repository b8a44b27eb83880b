// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_points.hpp"

#include <algorithm>
#include <cmath>

namespace curlidar {
namespace {

Vec3 on_axis(std::uint8_t axis, double along, double u, double v) {
  if (axis == 0) return {along, u, v};
  if (axis == 1) return {v, along, u};
  return {u, v, along};
}

double coordinate(const Vec3& p, std::size_t axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

}  // namespace

void leaf_points(const MapTile& tile, const MapLeaf& leaf, double spacing_m,
                 std::vector<MapSample>& points) {
  const double cell = leaf.size_m / leaf.cells;
  // No finer than a thousandth of a cell: a spacing of zero asks for no end of points.
  const auto parts = static_cast<int>(std::ceil(cell / std::max(spacing_m, cell / 1000) - 1e-9));
  const double u0 = coordinate(leaf.centre, (leaf.axis + 1u) % 3);
  const double v0 = coordinate(leaf.centre, (leaf.axis + 2u) % 3);
  const double middle = coordinate(leaf.centre, leaf.axis);
  const double reach = leaf.size_m / 2 + kLeafSlack_m;
  for (std::uint32_t i = 0; i < leaf.cells; ++i) {
    for (std::uint32_t j = 0; j < leaf.cells; ++j) {
      if (tile.footprint[leaf.first_cell + std::size_t{i} * leaf.cells + j] == 0) continue;
      for (int a = 0; a < parts; ++a) {
        const double du = (i + (a + 0.5) / parts) * cell - leaf.size_m / 2;
        for (int b = 0; b < parts; ++b) {
          const double dv = (j + (b + 0.5) / parts) * cell - leaf.size_m / 2;
          const double height = leaf_height(leaf, du, dv);
          if (std::abs(height - middle) > reach) continue;
          points.push_back({on_axis(leaf.axis, height, u0 + du, v0 + dv), 1, leaf.intensity});
        }
      }
    }
  }
}

std::vector<MapSample> tile_points(const MapTile& tile, double spacing_m) {
  std::vector<MapSample> points;
  for (const MapLeaf& leaf : tile.leaves) leaf_points(tile, leaf, spacing_m, points);
  return points;
}

}  // namespace curlidar
