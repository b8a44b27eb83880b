// SPDX-License-Identifier: BSD-3-Clause
// One tile of a surface map as bytes (docs/format/curl-surface-tile-1.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/map_settings.hpp"
#include "curlidar/map_tile.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// Every level of a tile's octree.
inline constexpr std::uint32_t kAllLevels = 255;

/// invalid_argument unless every value makes sense and the side is a whole number of roots.
Status validate(const SurfaceSettings& settings, double side_m);

/// The samples of a tile of `side_m` as bytes; none may be empty. Samples lie in [0, side_m) of x
/// and y, at any height; those which do not, or are not finite, are invalid_argument. The bytes
/// depend on the samples but not on their order. One thread; some microseconds a sample.
Result<std::vector<std::byte>> encode_surface_tile(const std::vector<MapSample>& samples,
                                                   const SurfaceSettings& settings, double side_m);

/// A tile that more was seen of.
struct LongerTile {
  std::vector<std::byte> bytes;  ///< none: nothing new is worth telling
  std::size_t explained = 0;     ///< samples near the old surface
};
/// The tile `old` and, in a pass after it, what samples tell that it does not: no leaf of it
/// changes. Its sizes stay, `settings` weigh. Errors: those of decoding and encoding.
Result<LongerTile> append_surface_tile(ByteSpan old, const std::vector<MapSample>& samples,
                                       const SurfaceSettings& settings,
                                       const TileLimits& limits = {});

/// The leaves of a tile, `key` and `origin` left alone. With `max_level`, leaves below that level
/// are told by one plane for each cube of that level which has any: fitted to their cells, over
/// their commonest axis. corrupt: the bytes are damaged; limit_exceeded.
Result<MapTile> decode_surface_tile(ByteSpan bytes, const TileLimits& limits = {},
                                    std::uint32_t max_level = kAllLevels);

}  // namespace curlidar
