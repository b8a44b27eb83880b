// SPDX-License-Identifier: BSD-3-Clause
// The files of tests/golden/compact decode to exactly what their twins say, for ever.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "curlidar/codec.hpp"
#include "golden/twin.hpp"

namespace curlidar {
namespace {

std::vector<std::byte> read_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// name -> (file, twin)
struct Pair {
  std::vector<std::byte> file;
  test::Json twin;
};

const std::map<std::string, Pair>& golden() {
  static const std::map<std::string, Pair> pairs = [] {
    std::map<std::string, Pair> found;
    for (const auto& entry : std::filesystem::directory_iterator(CURLIDAR_GOLDEN)) {
      if (entry.path().extension() != ".curl") continue;
      std::filesystem::path twin = entry.path();
      std::ifstream stream(twin.replace_extension(".json"));
      found[entry.path().stem()] = {read_file(entry.path()), test::Json::parse(stream)};
    }
    return found;
  }();
  return pairs;
}

TEST(Golden, CoversTheFormat) {
  std::size_t residual = 0, no_residual = 0, lattice = 0, segments = 0, height = 0, offset = 0;
  std::size_t rays = 0, cut = 0, part_of_a_turn = 0, rows = 0;
  for (const auto& [name, pair] : golden()) {
    const test::Json& twin = pair.twin;
    (twin["residual_step"] == 0 ? no_residual : residual) += 1;
    lattice += twin["lattice"] != 0;
    segments += twin["bands"] != 1 && twin["sectors"] != 1;
    height += !twin["height"].empty();
    offset += !twin["range_offset"].empty();
    cut += twin["complete"] == false;
    rays += twin.contains("rays");
    part_of_a_turn += twin["columns"] != twin["turn_columns"];
    rows = std::max<std::size_t>(rows, twin["rows"]);
  }
  EXPECT_GT(residual, 0u);
  EXPECT_GT(no_residual, 0u);
  EXPECT_GT(lattice, 0u);
  EXPECT_GT(segments, 0u);
  EXPECT_GT(height, 0u);
  EXPECT_GT(offset, 0u);
  EXPECT_GT(cut, 0u);
  EXPECT_GT(rays, 2u);
  EXPECT_GT(part_of_a_turn, 0u);
  EXPECT_EQ(rows, 128u);
}

TEST(Golden, FilesDecodeToTheirTwins) {
  for (const auto& [name, pair] : golden()) {
    SCOPED_TRACE(name);
    const Result<test::Json> twin = test::twin_of(pair.file);
    ASSERT_TRUE(twin) << twin.error().message;
    for (const auto& [key, value] : pair.twin.items()) {
      // Not EXPECT_EQ, which would print whole images.
      EXPECT_TRUE(twin.value()[key] == value) << key << " differs";
    }
    EXPECT_EQ(twin.value().size(), pair.twin.size());
  }
}

TEST(Golden, TheFacadeGivesTheSamePoints) {
  for (const auto& [name, pair] : golden()) {
    SCOPED_TRACE(name);
    DecodeOptions options;
    options.allow_truncated = pair.twin["complete"] == false;
    const Result<DecodedScan> scan = decode(pair.file, options);
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan.value().points.size(), pair.twin["returns"]);
    EXPECT_TRUE(test::every_nth(scan.value().points, pair.twin["points_every"]) ==
                pair.twin["points"]);
    EXPECT_EQ(scan.value().missing.empty(), pair.twin["complete"] == true);
  }
}

}  // namespace
}  // namespace curlidar
