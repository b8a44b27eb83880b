// SPDX-License-Identifier: BSD-3-Clause
#include "format/container.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/crc32c.hpp"
#include "support/chunks.hpp"

namespace curlidar {
namespace {

using test::bytes;
using testing::HasSubstr;
using testing::StartsWith;

std::vector<std::byte> file_of(std::initializer_list<std::pair<unsigned, unsigned>> chunks) {
  ContainerWriter writer;
  for (const auto& [type, size] : chunks) {
    writer.add(static_cast<ChunkType>(type), std::vector<std::byte>(size, std::byte{0x5a}));
  }
  return std::move(writer).finish();
}

TEST(Container, LaysBytesOutAsDocumented) {
  ContainerWriter writer;
  writer.add(ChunkType::sensor, bytes({1, 2, 3}));
  const auto file = std::move(writer).finish();
  const auto header = bytes({0x89, 'C', 'U', 'R', 'L', 0x0d, 0x0a, 0x00});
  const auto chunk = bytes({0x01, 0x03, 1, 2, 3});
  ASSERT_EQ(file.size(), 8u + 9u + 6u);
  EXPECT_TRUE(std::equal(header.begin(), header.end(), file.begin()));
  EXPECT_TRUE(std::equal(chunk.begin(), chunk.end(), file.begin() + 8));
  EXPECT_EQ(load_little_endian<std::uint32_t>(&file[13]), crc32c(chunk));
  EXPECT_EQ(file[17], std::byte{0});  // end chunk
  EXPECT_EQ(file[18], std::byte{0});
  EXPECT_EQ(load_little_endian<std::uint32_t>(&file[19]), crc32c(bytes({0, 0})));
}

TEST(Container, GivesChunksBack) {
  const auto file = file_of({{0x01, 0}, {0x80, 300}, {0x06, 5}});
  const auto chunks = read_container(file);
  ASSERT_TRUE(chunks) << chunks.error().message;
  ASSERT_EQ(chunks->size(), 3u);
  EXPECT_EQ((*chunks)[0].type, ChunkType::sensor);
  EXPECT_EQ((*chunks)[0].payload.size(), 0u);
  EXPECT_EQ((*chunks)[1].type, ChunkType::metadata);
  EXPECT_EQ((*chunks)[1].payload.size(), 300u);
  EXPECT_EQ((*chunks)[1].offset, 8u + 6u + 3u);
  EXPECT_EQ((*chunks)[2].payload.data(), file.data() + (*chunks)[2].offset);
  ASSERT_NE(find_chunk(*chunks, ChunkType::metadata), nullptr);
  EXPECT_EQ(find_chunk(*chunks, ChunkType::metadata)->payload.size(), 300u);
  EXPECT_EQ(find_chunk(*chunks, ChunkType::patches), nullptr);
  EXPECT_TRUE(require_chunk(*chunks, ChunkType::global));
  const auto missing = require_chunk(*chunks, ChunkType::patches);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::corrupt);
  EXPECT_THAT(missing.error().message, HasSubstr("no patches chunk"));
}

TEST(Container, AnEmptyFileHoldsNoChunks) {
  const auto chunks = read_container(file_of({}));
  ASSERT_TRUE(chunks);
  EXPECT_TRUE(chunks->empty());
}

TEST(Container, KeepsUnknownAncillaryRefusesUnknownCritical) {
  for (const unsigned type : {0x81u, 0xf0u, 0xffu}) {
    const auto chunks = read_container(file_of({{type, 2}, {type, 2}, {0x01, 1}}));
    ASSERT_TRUE(chunks) << chunks.error().message;
    EXPECT_EQ(chunks->size(), 3u);
  }
  for (const unsigned type : {0x08u, 0x70u, 0x7fu}) {
    const auto chunks = read_container(file_of({{0x01, 1}, {type, 2}}));
    ASSERT_FALSE(chunks);
    EXPECT_EQ(chunks.error().code, ErrorCode::unsupported);
    EXPECT_THAT(chunks.error().message, HasSubstr(to_string(static_cast<ChunkType>(type))));
  }
}

TEST(Container, RefusesAKnownChunkTwice) {
  for (const unsigned type : {0x01u, 0x80u}) {
    const auto chunks = read_container(file_of({{type, 1}, {0x02, 1}, {type, 1}}));
    ASSERT_FALSE(chunks);
    EXPECT_EQ(chunks.error().code, ErrorCode::corrupt);
    EXPECT_THAT(chunks.error().message, HasSubstr("a second"));
  }
}

TEST(Container, RefusesOtherVersions) {
  auto file = file_of({{0x01, 1}});
  file[7] = std::byte{1};
  const auto chunks = read_container(file);
  ASSERT_FALSE(chunks);
  EXPECT_EQ(chunks.error().code, ErrorCode::unsupported);
  EXPECT_THAT(chunks.error().message, HasSubstr("version 1"));
  EXPECT_TRUE(is_container(file));
}

TEST(Container, TellsOtherFilesAndTextTransfersApart) {
  const auto other = read_container(bytes({'#', ' ', '.', 'P', 'C', 'D', ' ', 'v'}));
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("not a .curl file"));
  auto file = file_of({{0x01, 1}});
  file.erase(file.begin() + 5);
  const auto mangled = read_container(file);
  ASSERT_FALSE(mangled);
  EXPECT_THAT(mangled.error().message, HasSubstr("text mode"));
  EXPECT_FALSE(is_container(file));
}

TEST(Container, RefusesBytesAfterTheEnd) {
  auto file = file_of({{0x01, 1}});
  file.push_back(std::byte{0});
  const auto chunks = read_container(file);
  ASSERT_FALSE(chunks);
  EXPECT_THAT(chunks.error().message, HasSubstr("1 bytes follow"));
}

TEST(Container, RefusesAnEndChunkWithPayload) {
  ContainerWriter writer;
  writer.add(ChunkType::end, bytes({1}));
  const auto chunks = read_container(std::move(writer).finish());
  ASSERT_FALSE(chunks);
  EXPECT_EQ(chunks.error().code, ErrorCode::corrupt);
  EXPECT_THAT(chunks.error().message, HasSubstr("end chunk is not empty"));
}

TEST(Container, DamageNamesChunkAndByte) {
  auto file = file_of({{0x01, 4}, {0x05, 4}});
  file[8 + 10 + 3] ^= std::byte{1};
  const auto chunks = read_container(file);
  ASSERT_FALSE(chunks);
  EXPECT_THAT(chunks.error().message, StartsWith("byte 18: the patches chunk is damaged"));
}

}  // namespace
}  // namespace curlidar
