// SPDX-License-Identifier: BSD-3-Clause
// A tile's encoder: root after root is searched with what the models have learnt so far, and coded.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/map_settings.hpp"
#include "curlidar/result.hpp"
#include "map/surface_tile.hpp"
#include "map/tile_decoder.hpp"

namespace curlidar::tile {

/// Errors as encode_surface_tile's.
Result<std::vector<std::byte>> encode_tile(const std::vector<MapSample>& samples,
                                           const SurfaceSettings& settings, double side_m);

/// A decoded tile, with its trees, and a pass more. Of one that has all passes it may have, the
/// last is made anew.
Result<LongerTile> encode_longer(DecodedTile old, const std::vector<MapSample>& samples,
                                 const SurfaceSettings& settings);

}  // namespace curlidar::tile
