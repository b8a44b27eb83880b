// SPDX-License-Identifier: BSD-3-Clause
// Tiles of surface maps made by hand.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "curlidar/map_tile.hpp"

namespace curlidar::test {

/// Adds a leaf with a full footprint.
inline MapLeaf& add_leaf(MapTile& tile, const Vec3& centre, double size_m, std::uint8_t axis,
                         double height_m, std::uint32_t cells = 2) {
  MapLeaf leaf;
  leaf.centre = centre;
  leaf.size_m = size_m;
  leaf.axis = axis;
  leaf.height_m = height_m;
  leaf.cells = cells;
  leaf.first_cell = tile.footprint.size();
  tile.footprint.resize(tile.footprint.size() + cells * cells, 1);
  tile.leaves.push_back(leaf);
  return tile.leaves.back();
}

/// The inside of the box [-x, x] x [-y, y] x [-z, z] in leaves of a metre; whole metres.
inline MapTile box_tile(int x, int y, int z) {
  MapTile tile;
  tile.side_m = 32;
  const int half[3] = {x, y, z};
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int i = -half[u]; i < half[u]; ++i) {
      for (int j = -half[v]; j < half[v]; ++j) {
        for (const int side : {-1, 1}) {
          double centre[3];
          centre[axis] = side * (half[axis] + 0.5);
          centre[u] = i + 0.5, centre[v] = j + 0.5;
          add_leaf(tile, {centre[0], centre[1], centre[2]}, 1, axis, side * half[axis]);
        }
      }
    }
  }
  return tile;
}

/// A ball around the origin: tangent planes, or with `curved` their second order, in cubes.
inline MapTile ball_tile(double radius, double size, bool curved) {
  MapTile tile;
  tile.side_m = 32;
  const int reach = static_cast<int>(std::ceil(radius / size));
  for (int i = -reach; i < reach; ++i) {
    for (int j = -reach; j < reach; ++j) {
      for (int k = -reach; k < reach; ++k) {
        const Vec3 centre = Vec3{i + 0.5, j + 0.5, k + 0.5} * size;
        const double out = norm(centre);
        if (std::abs(out - radius) > size * 0.87) continue;
        const Vec3 on = centre * (radius / out);
        const double p[3] = {on.x, on.y, on.z};
        std::uint8_t axis = 0;
        for (std::uint8_t a = 1; a < 3; ++a) {
          if (std::abs(p[a]) > std::abs(p[axis])) axis = a;
        }
        // w = sqrt(r^2 - u^2 - v^2), expanded about the place on the ball next to the centre.
        const double c[3] = {centre.x, centre.y, centre.z};
        const double u = p[(axis + 1) % 3], v = p[(axis + 2) % 3], w = p[axis];
        const double su = -u / w, sv = -v / w;
        const double uu = curved ? -(1 + su * su) / (2 * w) : 0;
        const double uv = curved ? -su * sv / w : 0;
        const double vv = curved ? -(1 + sv * sv) / (2 * w) : 0;
        const double du = c[(axis + 1) % 3] - u, dv = c[(axis + 2) % 3] - v;
        MapLeaf& leaf = add_leaf(tile, centre, size, axis, 0, 1);
        leaf.height_m = w + su * du + sv * dv + uu * du * du + uv * du * dv + vv * dv * dv;
        leaf.slope = {su + 2 * uu * du + uv * dv, sv + uv * du + 2 * vv * dv};
        leaf.curve = {uu, uv, vv};
      }
    }
  }
  return tile;
}

/// Leaves of any kind about the origin, with holes in their footprints.
inline MapTile random_tile(std::size_t count, std::uint32_t seed) {
  std::mt19937 engine(seed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(engine()) / 4294967296.0;
  };
  MapTile tile;
  tile.side_m = 32;
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 centre{draw(-4, 4), draw(-4, 4), draw(-4, 4)};
    const auto axis = static_cast<std::uint8_t>(engine() % 3);
    const double size = 0.25 * static_cast<double>(1u << engine() % 4);
    const double along = axis == 0 ? centre.x : axis == 1 ? centre.y : centre.z;
    MapLeaf& leaf =
        add_leaf(tile, centre, size, axis, along + draw(-0.5, 0.5) * size, 1u << engine() % 4);
    leaf.slope = {draw(-1.6, 1.6), draw(-1.6, 1.6)};
    if (engine() % 2 == 0) leaf.curve = {draw(-1, 1), draw(-1, 1), draw(-1, 1)};
    for (std::size_t i = leaf.first_cell; i < tile.footprint.size(); ++i) {
      tile.footprint[i] = engine() % 4 != 0;
    }
  }
  return tile;
}

}  // namespace curlidar::test
