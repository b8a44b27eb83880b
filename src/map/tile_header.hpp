// SPDX-License-Identifier: BSD-3-Clause
// The header of a tile: some seven bytes before its bits.
#pragma once

#include "base/bytes.hpp"
#include "curlidar/map_settings.hpp"
#include "curlidar/result.hpp"
#include "map/tile_geometry.hpp"

namespace curlidar::tile {

/// Of valid settings; rows not yet known.
TileLayout layout_of(const SurfaceSettings& settings, double side_m);

void write_header(ByteWriter& out, const TileLayout& layout);
/// corrupt: damaged, or what no writer writes.
Result<TileLayout> read_header(ByteReader& in);

}  // namespace curlidar::tile
