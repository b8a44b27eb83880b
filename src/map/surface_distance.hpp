// SPDX-License-Identifier: BSD-3-Clause
// How far points are from a tile's surface. Encoder only: + - * / and sqrt alone.
#pragma once

#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "curlidar/map_tile.hpp"

namespace curlidar::tile {

/// 200 bytes or so for each leaf.
class SurfaceDistance {
 public:
  /// `surface` must outlive it; distances are told up to `most_m`.
  SurfaceDistance(const MapTile& surface, double most_m);

  /// To the planes over set cells, from the tile's origin, metres; across a leaf its distance is
  /// that to the plane which touches it there.
  double of(const Vec3& p) const;

 private:
  double of(const MapLeaf& leaf, const Vec3& p, double most_m) const;

  /// Leaves of one size by the cubes that they reach into.
  struct Size {
    double edge_m = 1;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> leaves;
  };

  const MapTile& surface_;
  double most_m_;
  std::map<double, Size> sizes_;
};

}  // namespace curlidar::tile
