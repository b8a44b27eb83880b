// SPDX-License-Identifier: BSD-3-Clause
// The tiles of tests/golden/surface decode to exactly what their twins say, for ever.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "golden/surface_twin.hpp"
#include "map/surface_tile.hpp"

namespace curlidar {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(GoldenSurface, TilesDecodeToTheirTwins) {
  std::size_t tiles = 0;
  for (const auto& entry : std::filesystem::directory_iterator(CURLIDAR_GOLDEN_SURFACE)) {
    if (entry.path().extension() != ".tile") continue;
    SCOPED_TRACE(entry.path());
    const std::string bytes = text_of(entry.path());
    const auto tile = decode_surface_tile(std::as_bytes(std::span(bytes)));
    ASSERT_TRUE(tile) << tile.error().message;
    std::filesystem::path twin = entry.path();
    EXPECT_TRUE(test::surface_twin(*tile) == text_of(twin.replace_extension(".txt")));
    ++tiles;
  }
  EXPECT_GE(tiles, 5u);
}

}  // namespace
}  // namespace curlidar
