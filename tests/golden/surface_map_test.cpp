// SPDX-License-Identifier: BSD-3-Clause
// The golden surface map is read to the same tiles for ever, and written as ever.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "golden/surface_map.hpp"
#include "golden/surface_twin.hpp"

namespace curlidar {
namespace {

const std::string kTiles = CURLIDAR_GOLDEN_SURFACE;
const std::string kMap = kTiles + "/../surface_maps/four-tiles.curl";

TEST(GoldenSurfaceMap, IsReadToItsTiles) {
  const auto map = MapFile::open(kMap);
  ASSERT_TRUE(map) << map.error().message;
  const MapHeader expected = test::golden_header();
  EXPECT_EQ(map->header().origin, expected.origin);
  EXPECT_EQ(map->header().tile_side_m, expected.tile_side_m);
  EXPECT_EQ(map->header().metadata, expected.metadata);
  EXPECT_EQ(map->header().scans, expected.scans);
  EXPECT_EQ(map->header().travelled_m, expected.travelled_m);
  EXPECT_TRUE(map->header().surface.curves && map->header().surface.intensity);
  ASSERT_EQ(map->tiles().size(), std::size(test::kPlacedTiles));
  for (std::size_t i = 0; i < map->tiles().size(); ++i) {
    const test::PlacedTile& placed = test::kPlacedTiles[i];
    SCOPED_TRACE(placed.name);
    const MapTileEntry& entry = map->tiles()[i];
    EXPECT_EQ(entry.key, placed.key);
    const auto tile = map->read_tile(i);
    ASSERT_TRUE(tile) << tile.error().message;
    EXPECT_EQ(tile->leaves.size(), entry.leaves);
    const Vec3 corner = expected.origin + Vec3{placed.key.x * 16.0, placed.key.y * 16.0, 0};
    EXPECT_EQ(tile->origin, corner);
    EXPECT_TRUE(test::surface_twin(*tile) ==
                test::golden_text(kTiles + "/" + placed.name + ".txt"));
  }
}

TEST(GoldenSurfaceMap, IsWrittenAsEver) {
  const std::string path = testing::TempDir() + "curlidar-golden-surface-map.curl";
  const Status written = test::write_golden_map(kTiles, path);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_TRUE(test::golden_text(path) == test::golden_text(kMap));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace curlidar
