// SPDX-License-Identifier: BSD-3-Clause
// What commands share that look at surface maps.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common_inputs.hpp"
#include "curlidar/map.hpp"
#include "curlidar/map_view.hpp"

namespace curlidar::app {

/// Tiles of a map as far as they are whole.
struct MapTiles {
  std::vector<MapTile> tiles;
  std::size_t read = 0, damaged = 0, of = 0;
  std::vector<std::string> missing;  ///< what a map that was cut off lacks

  /// 3 if a tile was damaged: the result is there, but not of the whole map.
  int exit_code() const { return damaged > 0 ? kExitInput : kExitOk; }
  Json json() const;
};

/// A surface map; Failure for other files.
MapFile open_surface_map(const std::string& path, bool allow_truncated);
/// The tiles that meet the box, or all; a damaged one is told on standard error and left out.
MapTiles read_tiles(const MapFile& map, const std::optional<MapBox>& box = {});
/// The file starts as a map does.
bool is_map_file(const std::string& path);

/// "x,y,z,roll,pitch,yaw": metres and degrees; roll about x, then pitch about y, then yaw about z.
RigidMotion parse_pose(const std::string& text);

/// Clouds, scans with poses, or maps, in the frame of a map.
struct ReferenceOptions {
  std::vector<std::string> files;
  std::string poses, calib;
  double min_range_m = 2.5, max_range_m = 80;
  std::size_t max_points = 10'000'000;
};
void add_reference_options(CLI::App& app, ReferenceOptions& options);
/// All of them in one; maps as points every `spacing_m`. Damaged tiles count in `damaged`.
PointSubset read_reference(const ReferenceOptions& options, double spacing_m,
                           const ProgressCallback& progress, std::size_t& damaged);

}  // namespace curlidar::app
