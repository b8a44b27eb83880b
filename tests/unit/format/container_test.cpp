// SPDX-License-Identifier: BSD-3-Clause
#include "format/container.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "base/crc32c.hpp"
#include "support/chunks.hpp"

namespace curlidar {
namespace {

using test::bytes;
using testing::HasSubstr;
using testing::Not;
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
  const auto header = bytes({0x89, 'C', 'U', 'R', 'L', 0x0d, 0x0a, 0x01});
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
  for (const unsigned type : {0x8fu, 0xf0u, 0xffu}) {
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
  for (const unsigned type : {0x01u, 0x80u, 0x10u, 0x11u, 0x12u}) {
    const auto chunks = read_container(file_of({{type, 1}, {0x02, 1}, {type, 1}}));
    ASSERT_FALSE(chunks);
    EXPECT_EQ(chunks.error().code, ErrorCode::corrupt);
    EXPECT_THAT(chunks.error().message, HasSubstr("a second"));
  }
}

TEST(Container, ChunksOfSegmentsMayRepeat) {
  const auto file =
      file_of({{0x13, 1}, {0x13, 2}, {0x14, 3}, {0x14, 4}, {0x15, 5}, {0x15, 6}, {0x13, 7}});
  const auto chunks = read_container(file);
  ASSERT_TRUE(chunks) << chunks.error().message;
  EXPECT_EQ(chunks->size(), 7u);
  const auto masks = find_chunks(*chunks, ChunkType::compact_mask);
  ASSERT_EQ(masks.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(masks[i].type, ChunkType::compact_mask);
    EXPECT_EQ(masks[i].payload.size(), (std::array{1u, 2u, 7u}[i]));
  }
  EXPECT_EQ(find_chunk(*chunks, ChunkType::compact_field)->payload.size(), 3u);
  EXPECT_TRUE(find_chunks(*chunks, ChunkType::patches).empty());
}

TEST(Container, EveryTypeHasAName) {
  for (const unsigned type : {0x00u, 0x01u, 0x02u, 0x03u, 0x04u, 0x05u, 0x06u, 0x07u, 0x10u, 0x11u,
                              0x12u, 0x13u, 0x14u, 0x15u, 0x16u, 0x80u}) {
    EXPECT_THAT(to_string(static_cast<ChunkType>(type)), Not(StartsWith("0x")));
  }
  EXPECT_EQ(to_string(static_cast<ChunkType>(0x19)), "0x19");
}

TEST(Container, RefusesOtherVersions) {
  auto file = file_of({{0x01, 1}});
  for (const unsigned version : {0u, 2u, 255u}) {  // 0 was the draft
    file[7] = static_cast<std::byte>(version);
    const auto chunks = read_container(file);
    ASSERT_FALSE(chunks);
    EXPECT_EQ(chunks.error().code, ErrorCode::unsupported);
    EXPECT_THAT(chunks.error().message, HasSubstr("version " + std::to_string(version) + ","));
    EXPECT_TRUE(is_container(file));
    const auto prefix = read_container_prefix(file);
    ASSERT_FALSE(prefix);
    EXPECT_EQ(prefix.error().code, ErrorCode::unsupported);
  }
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

TEST(ContainerPrefix, OfAWholeFileIsComplete) {
  const auto file = read_container_prefix(file_of({{0x10, 3}, {0x13, 200}}));
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->complete);
  EXPECT_FALSE(file->torn);
  ASSERT_EQ(file->chunks.size(), 2u);
  EXPECT_EQ(file->chunks[1].payload.size(), 200u);
}

TEST(ContainerPrefix, TellsWhatIsThereOfEveryCut) {
  // header 8, chunk 1 + 1 + 3 + 4, chunk 1 + 2 + 200 + 4, end 1 + 1 + 4
  const auto whole = file_of({{0x10, 3}, {0x13, 200}});
  constexpr std::size_t kSecond = 17, kPayload = 20, kEnd = 224, kSize = 230;
  ASSERT_EQ(whole.size(), kSize);
  for (std::size_t size = kHeaderSize; size < kSize; ++size) {
    const auto file = read_container_prefix(ByteSpan(whole).first(size));
    ASSERT_TRUE(file) << size << ": " << file.error().message;
    EXPECT_FALSE(file->complete);
    EXPECT_EQ(file->chunks.size(), size < kSecond ? 0u : size < kEnd ? 1u : 2u) << size;
    EXPECT_EQ(file->cut_chunk, size < kSecond ? kHeaderSize : size < kEnd ? kSecond : kEnd);
    if (size >= kPayload && size < kEnd) {
      ASSERT_TRUE(file->torn) << size;
      EXPECT_EQ(file->torn->type, ChunkType::compact_mask);
      EXPECT_EQ(file->torn->size, 200u);
      EXPECT_EQ(file->torn->offset, kPayload);
      EXPECT_EQ(file->torn->payload.size(), std::min<std::size_t>(size - kPayload, 200));
      EXPECT_EQ(file->torn->payload.data(), whole.data() + kPayload);
    }
    if (size >= kSecond && size < kPayload) {
      EXPECT_FALSE(file->torn) << size;
    }
    if (size == kSize - 1) {
      ASSERT_TRUE(file->torn);
      EXPECT_EQ(file->torn->type, ChunkType::end);
    }
  }
}

TEST(ContainerPrefix, DamageIsStillAnError) {
  auto file = file_of({{0x10, 3}, {0x13, 200}});
  file.resize(100);
  file[11] ^= std::byte{1};
  const auto prefix = read_container_prefix(file);
  ASSERT_FALSE(prefix);
  EXPECT_EQ(prefix.error().code, ErrorCode::corrupt);
  EXPECT_THAT(prefix.error().message,
              StartsWith("byte 8: the compact_parameters chunk is damaged"));
}

TEST(ContainerPrefix, ATornChunkKeepsTheRulesOfTypes) {
  auto twice = file_of({{0x10, 3}, {0x10, 200}});
  twice.resize(100);
  const auto second = read_container_prefix(twice);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("a second compact_parameters chunk"));
  auto unknown = file_of({{0x10, 3}, {0x70, 200}});
  unknown.resize(100);
  const auto critical = read_container_prefix(unknown);
  ASSERT_FALSE(critical);
  EXPECT_EQ(critical.error().code, ErrorCode::unsupported);
}

TEST(ContainerPrefix, ASizeOfMoreThan64BitsIsDamage) {
  auto file = bytes({0x89, 'C', 'U', 'R', 'L', 0x0d, 0x0a, 0x01, 0x13});
  for (int i = 0; i < 9; ++i) file.push_back(std::byte{0xff});
  const auto cut = read_container_prefix(file);
  ASSERT_TRUE(cut);
  EXPECT_FALSE(cut->torn);
  EXPECT_EQ(cut->cut_chunk, kHeaderSize);
  file.push_back(std::byte{0x7f});
  const auto damaged = read_container_prefix(file);
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().message, HasSubstr("no valid size"));
  file.back() = std::byte{0x01};  // 2^64 - 1 bytes
  const auto huge = read_container_prefix(file);
  ASSERT_TRUE(huge);
  ASSERT_TRUE(huge->torn);
  EXPECT_EQ(huge->torn->size, UINT64_MAX);
  EXPECT_EQ(huge->torn->payload.size(), 0u);
}

TEST(ContainerPrefix, NothingComesFromACutHeader) {
  const auto file = file_of({});
  for (std::size_t size = 0; size < kHeaderSize; ++size) {
    EXPECT_FALSE(read_container_prefix(ByteSpan(file).first(size))) << size;
  }
}

}  // namespace
}  // namespace curlidar
