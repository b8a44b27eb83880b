// SPDX-License-Identifier: BSD-3-Clause
// How far points are from a tile's surface. Encoder only: + - * / and sqrt alone.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "curlidar/map_tile.hpp"

namespace curlidar::tile {

/// Some bytes for each leaf and cube of a metre or so that it reaches into.
class SurfaceDistance {
 public:
  /// `surface` must outlive it; distances are told up to `most_m`.
  SurfaceDistance(const MapTile& surface, double most_m);

  /// To the planes over set cells, from the tile's origin, metres; across a leaf its distance is
  /// that to the plane which touches it there.
  double of(const Vec3& p) const;

 private:
  double of(const MapLeaf& leaf, const Vec3& p, double most_m) const;

  const MapTile& surface_;
  double most_m_, edge_m_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> leaves_;  ///< by cube
};

}  // namespace curlidar::tile
