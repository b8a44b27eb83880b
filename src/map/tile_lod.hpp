// SPDX-License-Identifier: BSD-3-Clause
// Coarser tiles from finer ones.
#pragma once

#include <cstdint>

#include "curlidar/map_tile.hpp"
#include "map/tile_geometry.hpp"

namespace curlidar::tile {

/// The tile with every leaf below `max_level` merged into one plane for each cube of that level: of
/// least squares through the middles of their set cells, over the axis of the largest part of them.
MapTile coarser(const MapTile& tile, const TileLayout& layout, std::uint32_t max_level);

}  // namespace curlidar::tile
