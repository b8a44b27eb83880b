// SPDX-License-Identifier: BSD-3-Clause
// Points on the surface of a decoded tile.
#pragma once

#include <vector>

#include "curlidar/map_settings.hpp"
#include "curlidar/map_tile.hpp"

namespace curlidar {

/// How far beyond its cube a leaf's surface still counts, metres: what rounding of its plane leaves
/// open there would be a crack.
inline constexpr double kLeafSlack_m = 0.05;

/// p[axis] of a leaf's surface at du, dv from its centre.
inline double leaf_height(const MapLeaf& leaf, double du, double dv) {
  return leaf.height_m + leaf.slope[0] * du + leaf.slope[1] * dv + leaf.curve[0] * du * du +
         leaf.curve[1] * du * dv + leaf.curve[2] * dv * dv;
}

/// Appends points of one leaf, not farther than `spacing_m` from each other along u and v, centred
/// in every cell of its footprint, without those that leave the cube by more than kLeafSlack_m.
/// From the tile's origin; weight 1.
void leaf_points(const MapTile& tile, const MapLeaf& leaf, double spacing_m,
                 std::vector<MapSample>& points);

/// Those of all leaves.
std::vector<MapSample> tile_points(const MapTile& tile, double spacing_m);

}  // namespace curlidar
