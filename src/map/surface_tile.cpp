// SPDX-License-Identifier: BSD-3-Clause
#include "map/surface_tile.hpp"

#include <utility>

#include "base/try.hpp"
#include "map/tile_decoder.hpp"
#include "map/tile_encoder.hpp"
#include "map/tile_lod.hpp"

namespace curlidar {

Result<std::vector<std::byte>> encode_surface_tile(const std::vector<MapSample>& samples,
                                                   const SurfaceSettings& settings, double side_m) {
  return tile::encode_tile(samples, settings, side_m);
}

Result<LongerTile> append_surface_tile(ByteSpan old, const std::vector<MapSample>& samples,
                                       const SurfaceSettings& settings, const TileLimits& limits) {
  CURLIDAR_TRY_ASSIGN(decoded, tile::decode_tile(old, limits, true));
  return tile::encode_longer(std::move(decoded), samples, settings);
}

Result<MapTile> decode_surface_tile(ByteSpan bytes, const TileLimits& limits,
                                    std::uint32_t max_level) {
  CURLIDAR_TRY_ASSIGN(decoded, tile::decode_tile(bytes, limits, false));
  if (max_level < decoded.layout.levels) {
    return tile::coarser(decoded.tile, decoded.layout, max_level);
  }
  return std::move(decoded.tile);
}

}  // namespace curlidar
