// SPDX-License-Identifier: BSD-3-Clause
// A tile of a map and what was seen of it since.
#pragma once

#include <vector>

#include "curlidar/map_settings.hpp"
#include "curlidar/map_tile.hpp"

namespace curlidar {

/// How much an old surface's points count: it is resampled where it is and must hold its place
/// against nothing but itself.
inline constexpr float kOldWeight = 1;

/// What to make a tile of anew; empty if the old one already tells all that is worth telling.
struct AppendedSamples {
  std::vector<MapSample> samples;
  std::size_t explained = 0;  ///< new ones that lie on the old surface
};
/// A new sample counts if it is not within half a footprint's cell beside the old surface and near
/// it across, and if enough others do around it: what stands alone would not be coded.
AppendedSamples appended_samples(const MapTile& old, const std::vector<MapSample>& added,
                                 const SurfaceSettings& settings);

}  // namespace curlidar
