// SPDX-License-Identifier: BSD-3-Clause
// The samples of all tiles of a map that is being built: those near the sensor in memory, the
// others in a temporary file.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "curlidar/map_settings.hpp"
#include "curlidar/map_tile.hpp"
#include "curlidar/result.hpp"
#include "map/sample_grid.hpp"
#include "mapfile/spill_file.hpp"

namespace curlidar {

class TileStore {
 public:
  /// Holds about `max_samples` at once; side and thinning in metres.
  TileStore(double side_m, double thinning_m, std::size_t max_samples)
      : side_m_(side_m), thinning_m_(thinning_m), max_samples_(max_samples) {}

  /// Puts a point, from the map's origin, into its tile; limit_exceeded beyond 2^20 tiles.
  Status add(const Vec3& position, float intensity);
  /// To be called after each scan: what is beyond the limit goes to the file, tiles that were not
  /// hit for longest first. Errors: io.
  Status settle();

  /// In the order of keys.
  std::vector<TileKey> keys() const;
  /// All samples of a tile, which the store forgets in memory. What was put aside in pieces adds up
  /// to what would have been held: the limit never changes a sample. Threads may take different
  /// tiles at once.
  Result<std::vector<MapSample>> take(TileKey key);
  std::size_t most_samples() const { return most_; }

 private:
  struct Run {
    std::uint64_t offset = 0, bytes = 0;
  };
  struct Tile {
    SampleGrid grid;
    std::vector<Run> runs;
    std::uint64_t touched = 0;  ///< number of the scan that hit it last
  };

  Status put_aside(Tile& tile);

  double side_m_, thinning_m_;
  std::size_t max_samples_;
  std::map<TileKey, Tile> tiles_;
  Tile* last_ = nullptr;  ///< points come in clusters
  TileKey last_key_{};
  std::uint64_t scan_ = 0;
  std::size_t held_ = 0, most_ = 0;
  SpillFile file_;
};

}  // namespace curlidar
