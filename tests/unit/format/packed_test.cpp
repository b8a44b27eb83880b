// SPDX-License-Identifier: BSD-3-Clause
#include "format/packed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "support/chunks.hpp"

namespace curlidar {
namespace {

using test::bytes;
using test::chunk_of;
using testing::HasSubstr;

std::vector<std::byte> noise(std::size_t size) {
  std::mt19937 engine(5);
  std::vector<std::byte> out(size);
  for (std::byte& b : out) b = static_cast<std::byte>(engine() & 0xff);
  return out;
}

TEST(Packed, RoundTripsEverySize) {
  for (const std::size_t size : {0u, 1u, 7u, 200u, 300000u}) {
    for (const auto& raw : {std::vector<std::byte>(size, std::byte{7}), noise(size)}) {
      const auto packed = pack(raw);
      PayloadReader reader(chunk_of(ChunkType::patches, packed));
      const auto back = unpack(reader, "block", size);
      ASSERT_TRUE(back) << back.error().message;
      EXPECT_EQ(*back, raw);
      EXPECT_TRUE(reader.finish());
    }
  }
}

TEST(Packed, ShrinksRunsAndNeverGrowsNoiseByMoreThanItsHead) {
  EXPECT_LT(pack(std::vector<std::byte>(100000)).size(), 40u);
  EXPECT_EQ(pack(noise(50)).size(), 51u);
  EXPECT_EQ(pack(noise(100000)).size(), 100003u);
  EXPECT_EQ(pack({}), bytes({0}));
}

TEST(Packed, BlocksFollowEachOther) {
  ByteWriter writer;
  writer.write_bytes(pack(std::vector<std::byte>(1000)));
  writer.write_bytes(pack(noise(10)));
  const auto payload = std::move(writer).bytes();
  PayloadReader reader(chunk_of(ChunkType::patches, payload));
  EXPECT_TRUE(unpack_exactly(reader, "first", 1000));
  EXPECT_TRUE(unpack_exactly(reader, "second", 10));
  EXPECT_TRUE(reader.finish());
}

TEST(Packed, HoldsToTheLimit) {
  const auto packed = pack(std::vector<std::byte>(1000));
  PayloadReader reader(chunk_of(ChunkType::patches, packed));
  const auto raw = unpack(reader, "block", 999);
  ASSERT_FALSE(raw);
  EXPECT_EQ(raw.error().code, ErrorCode::limit_exceeded);
  EXPECT_THAT(raw.error().message, HasSubstr("patches chunk"));
}

TEST(Packed, AnotherSizeThanExpectedIsCorrupt) {
  const auto packed = pack(std::vector<std::byte>(1000));
  for (const std::uint64_t size : {0u, 999u, 1001u}) {
    PayloadReader reader(chunk_of(ChunkType::patches, packed));
    const auto raw = unpack_exactly(reader, "block", size);
    ASSERT_FALSE(raw);
    EXPECT_EQ(raw.error().code, ErrorCode::corrupt);
  }
}

TEST(Bits, LowestBitFirstInRasterOrder) {
  const std::vector<std::uint8_t> cells{1, 0, 0, 1, 0, 0, 0, 0, 0, 255};
  EXPECT_EQ(pack_bits(cells), bytes({4, 0x09, 0x02}));
}

TEST(Bits, RoundTripEverySize) {
  std::mt19937 engine(9);
  for (std::size_t size = 0; size < 70; ++size) {
    std::vector<std::uint8_t> cells(size);
    for (auto& cell : cells) cell = static_cast<std::uint8_t>(engine() & 1);
    const auto packed = pack_bits(cells);
    PayloadReader reader(chunk_of(ChunkType::point_grid, packed));
    const auto back = unpack_bits(reader, "grid", size);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(*back, cells);
    EXPECT_TRUE(reader.finish());
  }
}

TEST(Bits, RefusesStrayBits) {
  const auto payload = bytes({4, 0xff, 0x07});
  PayloadReader eleven(chunk_of(ChunkType::point_grid, payload));
  EXPECT_TRUE(unpack_bits(eleven, "grid", 11));
  PayloadReader ten(chunk_of(ChunkType::point_grid, payload));
  const auto stray = unpack_bits(ten, "grid", 10);
  ASSERT_FALSE(stray);
  EXPECT_THAT(stray.error().message, HasSubstr("beyond its last cell"));
}

TEST(Planes, BringEqualPlacesTogether) {
  const auto values = bytes({1, 2, 3, 4, 5, 6});
  EXPECT_EQ(split_planes(values, 2), bytes({1, 3, 5, 2, 4, 6}));
  EXPECT_EQ(split_planes(values, 3), bytes({1, 4, 2, 5, 3, 6}));
  EXPECT_EQ(join_planes(split_planes(values, 3), 3), values);
  EXPECT_EQ(split_planes(values, 1), values);
}

}  // namespace
}  // namespace curlidar
