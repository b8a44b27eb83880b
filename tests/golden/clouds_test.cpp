// SPDX-License-Identifier: BSD-3-Clause
// The golden files with every return decode to their twins for ever.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <vector>

#include "golden/clouds_twin.hpp"

namespace curlidar {
namespace {

TEST(GoldenClouds, DecodeToTheirTwins) {
  std::set<std::string> lattices;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(CURLIDAR_GOLDEN "/../clouds")) {
    if (entry.path().extension() != ".curl") continue;
    SCOPED_TRACE(entry.path().string());
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
    const auto scan = decode(std::as_bytes(std::span(text)));
    ASSERT_TRUE(scan) << scan.error().message;
    ASSERT_TRUE(scan->cloud);
    std::filesystem::path twin = entry.path();
    const auto wanted = test::Json::parse(std::ifstream(twin.replace_extension(".json")));
    const auto found = test::twin_of(*scan);
    for (const auto& [key, value] : wanted.items()) {
      // Not EXPECT_EQ, which would print whole clouds.
      EXPECT_TRUE(found[key] == value) << key << " differs";
    }
    EXPECT_EQ(found.size(), wanted.size());
    lattices.insert(wanted["lattice"].get<std::string>());
    ++files;
  }
  EXPECT_GE(files, 6u);
  EXPECT_EQ(lattices, (std::set<std::string>{"none", "rings", "rays"}));
}

}  // namespace
}  // namespace curlidar
