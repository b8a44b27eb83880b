// SPDX-License-Identifier: BSD-3-Clause
// What a surface map is made of: square pieces of surface in a world frame, tile by tile.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "curlidar/vec3.hpp"

namespace curlidar {

/// A tile: all heights over a square of the map's xy plane, [x, x + 1) x [y, y + 1) in sides of a
/// tile from the map's origin.
struct TileKey {
  std::int32_t x = 0, y = 0;
  friend auto operator<=>(const TileKey&, const TileKey&) = default;
};

/// A piece of surface inside a cube: one coordinate (`axis`) as a polynomial of the other two,
/// u = (axis + 1) % 3 and v = (axis + 2) % 3, where a bitmap says that the surface was seen.
struct MapLeaf {
  Vec3 centre{};      ///< of the cube, from the tile's origin, metres
  double size_m = 0;  ///< edge of the cube
  std::uint8_t axis = 2;
  std::uint8_t level = 0;  ///< 0: a root of the octree; each level halves the edge
  /// p[axis] = height + slope[0] du + slope[1] dv + curve[0] du^2 + curve[1] du dv + curve[2] dv^2,
  /// du and dv from the centre, metres. Planes have no curve. The surface may leave the cube.
  double height_m = 0;
  std::array<double, 2> slope{};
  std::array<double, 3> curve{};
  /// The footprint: cells x cells over the cube's face, cell (i, j) covering du in
  /// [i, i + 1) size / cells - size / 2 and dv likewise, at footprint[first_cell + i cells + j].
  std::uint32_t cells = 1;
  std::size_t first_cell = 0;
  /// Mean of what was measured there; NaN where the map holds none.
  float intensity = std::numeric_limits<float>::quiet_NaN();
};

/// A decoded tile.
struct MapTile {
  TileKey key;
  Vec3 origin{};      ///< of the tile in the map's frame, metres
  double side_m = 0;  ///< of the tile
  std::vector<MapLeaf> leaves;
  std::vector<std::uint8_t> footprint;  ///< 0 or 1 a cell
};

}  // namespace curlidar
