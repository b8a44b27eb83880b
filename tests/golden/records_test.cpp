// SPDX-License-Identifier: BSD-3-Clause
// The golden chunks of order and attributes decode to their twins for ever.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "golden/records_twin.hpp"

namespace curlidar {
namespace {

TEST(GoldenRecords, DecodeToTheirTwins) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(CURLIDAR_GOLDEN "/../records")) {
    SCOPED_TRACE(entry.path().string());
    const test::Json twin = test::Json::parse(std::ifstream(entry.path()));
    const test::TwinGrid grid(twin["grid"]);
    const auto order_payload = test::bytes_of_hex(twin["order_payload"]);
    const auto records_payload = test::bytes_of_hex(twin["records_payload"]);
    const auto order =
        decode_order({ChunkType::order, order_payload, 0}, grid.geometry().grid, 1 << 20);
    ASSERT_TRUE(order) << order.error().message;
    EXPECT_EQ(test::json_of(*order), twin["order"]);
    const auto attributes =
        read_records({ChunkType::records, records_payload, 0}, *order, grid.geometry(), 1 << 24);
    ASSERT_TRUE(attributes) << attributes.error().message;
    EXPECT_TRUE(test::json_of(*attributes) == twin["attributes"]);
    ++files;
  }
  EXPECT_GE(files, 5u);
}

}  // namespace
}  // namespace curlidar
