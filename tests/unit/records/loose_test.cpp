// SPDX-License-Identifier: BSD-3-Clause
#include "records/loose.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace curlidar {
namespace {

TEST(Loose, ComesBackBitForBit) {
  const std::vector<Vec3> points{{1, 2, 3}, {-0.0, 1e7, 0.5}};
  const auto coded = encode_loose(points, ScalarType::float32, {});
  ASSERT_TRUE(coded);
  const auto decoded = decode_loose({ChunkType::loose, coded->bytes, 0}, 2);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(*decoded, points);
  EXPECT_FALSE(decode_loose({ChunkType::loose, coded->bytes, 0}, 1));
}

TEST(Loose, MortonOrderIsAPermutationThatKeepsNeighboursTogether) {
  const std::vector<Vec3> points{{0, 0, 0}, {100, 100, 100}, {1, 0, 0}, {99, 100, 100}};
  EXPECT_EQ(morton_order(points), (std::vector<std::uint32_t>{0, 2, 3, 1}));
  EXPECT_TRUE(morton_order({}).empty());
}

}  // namespace
}  // namespace curlidar
