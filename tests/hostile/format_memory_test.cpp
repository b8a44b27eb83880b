// SPDX-License-Identifier: BSD-3-Clause
// Files that claim much and hold little: refused before memory is taken for the claim.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <cstdlib>
#include <new>

#include "support/chunks.hpp"
#include "support/curl_files.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CURLIDAR_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define CURLIDAR_SANITIZED
#endif
#endif

namespace {
thread_local std::size_t largest_request = 0;
}

// Notes the largest request of memory. Sanitizers need their own operators; inlined, gcc 12 would
// take malloc and free for mismatched.
#ifndef CURLIDAR_SANITIZED
[[gnu::noinline]] void* operator new(std::size_t size) {
  largest_request = std::max(largest_request, size);
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
#endif

namespace curlidar {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kHuge[] = {1u << 17, 1ull << 31, 1ull << 32, 1ull << 62, ~0ull};
/// What a reader may take for small things: texts, messages, tables of its own.
constexpr std::size_t kSmall = 1u << 16;

std::vector<std::byte> frame_of_zeros(std::size_t size) {
  const std::vector<std::byte> zeros(size);
  std::vector<std::byte> frame(ZSTD_compressBound(size));
  frame.resize(ZSTD_compress(frame.data(), frame.size(), zeros.data(), size, 19));
  return frame;
}

std::vector<std::byte> block_claiming(std::uint64_t size, const std::vector<std::byte>& frame) {
  ByteWriter writer;
  writer.write_varint(2 * size + 1);
  writer.write_varint(frame.size());
  writer.write_bytes(frame);
  return std::move(writer).bytes();
}

Result<std::vector<std::byte>> unpack_block(const std::vector<std::byte>& block,
                                            std::uint64_t limit) {
  PayloadReader reader(test::chunk_of(ChunkType::patches, block));
  return unpack(reader, "block", limit);
}

TEST(FormatMemory, BombsClaimingToBeSmall) {
  const auto frame = frame_of_zeros(100u << 20);
  ASSERT_LT(frame.size(), 20000u);
  for (const std::uint64_t claim : {0u, 1u, 1000u, 60000u}) {
    const auto block = block_claiming(claim, frame);
    largest_request = 0;
    const auto raw = unpack_block(block, 1u << 16);
    ASSERT_FALSE(raw);
    EXPECT_EQ(raw.error().code, ErrorCode::corrupt);
    EXPECT_LE(largest_request, kSmall);
  }
}

TEST(FormatMemory, BombsThatSayWhatTheyAreMeetTheLimit) {
  const auto block = block_claiming(100u << 20, frame_of_zeros(100u << 20));
  largest_request = 0;
  const auto raw = unpack_block(block, 1u << 20);
  ASSERT_FALSE(raw);
  EXPECT_EQ(raw.error().code, ErrorCode::limit_exceeded);
  EXPECT_LE(largest_request, kSmall);
}

TEST(FormatMemory, FramesTooShortForTheirClaim) {
  for (const std::uint64_t claim : {std::uint64_t{1} << 24, std::uint64_t{1} << 32}) {
    // Frame header with the claimed size in 8 bytes, then one run-length block.
    ByteWriter writer;
    writer.write(std::uint32_t{ZSTD_MAGICNUMBER});
    writer.write(std::uint8_t{0xe0});
    writer.write(claim);
    writer.write_bytes(test::bytes({0x03, 0x00, 0x10, 0x00}));
    const auto block = block_claiming(claim, writer.bytes());
    largest_request = 0;
    const auto raw = unpack_block(block, 1ull << 33);
    ASSERT_FALSE(raw);
    EXPECT_EQ(raw.error().code, ErrorCode::corrupt);
    EXPECT_LE(largest_request, kSmall);
  }
}

TEST(FormatMemory, HugeNumbersAtEveryPlace) {
  const auto file = test::whole_file();
  const auto chunks = read_container(file);
  ASSERT_TRUE(chunks);
  for (const Chunk& chunk : *chunks) {
    for (const std::uint64_t huge : kHuge) {
      for (std::size_t at = 0; at < chunk.payload.size(); ++at) {
        ByteWriter writer;
        writer.write_bytes(chunk.payload.first(at));
        writer.write_varint(huge);
        writer.write_bytes(chunk.payload.subspan(at + 1));
        largest_request = 0;
        const Status status = test::read_chunk({chunk.type, writer.bytes(), chunk.offset});
        ASSERT_LE(largest_request, test::kMaxBytes) << to_string(chunk.type) << ", byte " << at;
        if (!status) {
          ASSERT_THAT(status.error().message, HasSubstr("byte"));
        }
      }
    }
  }
}

TEST(FormatMemory, HugeChunkSizes) {
  for (const std::uint64_t huge : kHuge) {
    ByteWriter writer;
    writer.write_bytes(ByteSpan(test::whole_file()).first(kHeaderSize));
    writer.write(std::uint8_t{0x05});
    writer.write_varint(huge);
    writer.write_bytes(std::vector<std::byte>(50));
    largest_request = 0;
    const Status status = test::read_all_chunks(writer.bytes());
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("byte 8: the patches chunk claims"));
    EXPECT_LE(largest_request, kSmall);
  }
}

TEST(FormatMemory, EndlessVarints) {
  const std::vector<std::byte> payload(64, std::byte{0xff});
  for (unsigned type = 0; type < 256; ++type) {
    const Status status = test::read_chunk({static_cast<ChunkType>(type), payload, 8});
    if (!status) {
      EXPECT_THAT(status.error().message, HasSubstr("byte"));
    }
  }
  auto file = test::whole_file();
  std::fill(file.begin() + kHeaderSize + 1, file.end(), std::byte{0xff});
  EXPECT_FALSE(test::read_all_chunks(file));
}

TEST(FormatMemory, TooManyChunks) {
  const auto file_with = [](std::size_t chunks) {
    ContainerWriter writer;
    for (std::size_t i = 0; i < chunks; ++i) writer.add(static_cast<ChunkType>(0xf0), {});
    return std::move(writer).finish();
  };
  EXPECT_TRUE(read_container(file_with(kMaxChunks)));
  const auto chunks = read_container(file_with(kMaxChunks + 1));
  ASSERT_FALSE(chunks);
  EXPECT_EQ(chunks.error().code, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace curlidar
