// SPDX-License-Identifier: BSD-3-Clause
// Predicted golden files decode to their twins, each from the one before.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "compact/scan_decoder.hpp"
#include "format/container.hpp"

namespace curlidar {
namespace {

TEST(Predicted, GoldenFilesDecodeToTheirTwins) {
  using namespace compact;
  DecodedScan before;
  for (int number = 0; number < 4; ++number) {
    const std::string path =
        std::string(CURLIDAR_GOLDEN) + "/../predicted/street-" + std::to_string(number);
    std::ifstream file(path + ".curl", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto chunks = read_container(std::as_bytes(std::span(text.data(), text.size())));
    ASSERT_TRUE(chunks) << path;
    ScanChunks views;
    for (const Chunk& chunk : *chunks) {
      views.chunks.push_back(
          {static_cast<ScanPart>(chunk.type), chunk.payload, chunk.offset, true});
    }
    ScanOptions options;
    options.reference = &before;
    auto scan = decode_scan(views, {}, options);
    ASSERT_TRUE(scan) << scan.error().message;
    const auto twin = nlohmann::json::parse(std::ifstream(path + ".json"));
    EXPECT_EQ(scan->range, twin["range"].get<std::vector<std::int32_t>>());
    EXPECT_EQ(scan->field_range, twin["field"].get<std::vector<std::int32_t>>());
    before = *std::move(scan);
  }
}

}  // namespace
}  // namespace curlidar
