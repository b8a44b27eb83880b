// SPDX-License-Identifier: BSD-3-Clause
// Cut, flipped and random .curl files: an error that names the place, never a crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/chunks.hpp"
#include "support/curl_files.hpp"

namespace curlidar {
namespace {

using test::read_all_chunks;
using test::with_right_checksums;
using testing::HasSubstr;

constexpr ChunkType kTypes[] = {ChunkType::sensor,  ChunkType::parameters, ChunkType::point_grid,
                                ChunkType::patches, ChunkType::attributes, ChunkType::metadata};

TEST(FormatDamage, TheWholeFileIsGood) {
  const Status status = read_all_chunks(test::whole_file());
  EXPECT_TRUE(status) << status.error().message;
}

TEST(FormatDamage, EveryCutIsFound) {
  const auto file = test::whole_file();
  for (std::size_t size = 0; size < file.size(); ++size) {
    const Status status = read_all_chunks(ByteSpan(file).first(size));
    ASSERT_FALSE(status) << "cut to " << size << " bytes";
    EXPECT_EQ(status.error().code, ErrorCode::corrupt);
    EXPECT_THAT(status.error().message, HasSubstr("byte"));
  }
}

TEST(FormatDamage, EveryCutGivesTheChunksBeforeIt) {
  const auto file = test::whole_file();
  const auto whole = read_container(file);
  ASSERT_TRUE(whole);
  for (std::size_t size = kHeaderSize; size < file.size(); ++size) {
    const auto prefix = read_container_prefix(ByteSpan(file).first(size));
    ASSERT_TRUE(prefix) << "cut to " << size << " bytes: " << prefix.error().message;
    EXPECT_FALSE(prefix->complete);
    for (std::size_t i = 0; i < prefix->chunks.size(); ++i) {
      EXPECT_EQ(prefix->chunks[i].offset, (*whole)[i].offset);
    }
    const std::size_t left = size - prefix->cut_chunk;
    EXPECT_LE(prefix->torn ? prefix->torn->payload.size() : 0, left);
    ASSERT_LE(prefix->cut_chunk, size);
  }
}

TEST(FormatDamage, AFlippedBitNeverLooksComplete) {
  const auto file = test::whole_file();
  for (std::size_t i = 0; i < file.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      auto damaged = file;
      damaged[i] ^= std::byte{1} << bit;
      const auto prefix = read_container_prefix(damaged);
      ASSERT_FALSE(prefix && prefix->complete) << "bit " << bit << " of byte " << i;
    }
  }
}

TEST(FormatDamage, EveryFlippedBitIsFound) {
  const auto file = test::whole_file();
  for (std::size_t i = 0; i < file.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      auto damaged = file;
      damaged[i] ^= std::byte{1} << bit;
      const Status status = read_all_chunks(damaged);
      ASSERT_FALSE(status) << "bit " << bit << " of byte " << i;
      EXPECT_THAT(status.error().message, HasSubstr("byte"));
    }
  }
}

TEST(FormatDamage, FlipsUnderARightChecksumReachThePayloadReaders) {
  const auto file = test::whole_file();
  std::size_t refused_by_payload = 0;
  for (std::size_t i = kHeaderSize; i < file.size(); ++i) {
    for (const unsigned flip : {0x01u, 0x80u, 0xffu, 0x7fu}) {
      auto damaged = file;
      damaged[i] ^= static_cast<std::byte>(flip);
      const Status status = read_all_chunks(with_right_checksums(damaged));
      if (status) continue;
      EXPECT_THAT(status.error().message, HasSubstr("byte")) << "byte " << i;
      refused_by_payload += status.error().message.find("chunk, byte") != std::string::npos;
    }
  }
  EXPECT_GT(refused_by_payload, file.size() / 2);
}

TEST(FormatDamage, CutPayloadsUnderARightChecksum) {
  const auto file = test::whole_file();
  const auto chunks = read_container(file);
  ASSERT_TRUE(chunks);
  for (const Chunk& chunk : *chunks) {
    if (chunk.type == static_cast<ChunkType>(0xf1)) continue;
    for (std::size_t size = 0; size < chunk.payload.size(); ++size) {
      const Status status = test::read_chunk({chunk.type, chunk.payload.first(size), chunk.offset});
      ASSERT_FALSE(status) << to_string(chunk.type) << " cut to " << size;
      EXPECT_THAT(status.error().message, HasSubstr(to_string(chunk.type) + " chunk, byte"));
    }
  }
}

TEST(FormatDamage, RandomPayloads) {
  std::mt19937 engine(1);
  std::vector<std::byte> payload;
  for (int round = 0; round < 20000; ++round) {
    payload.resize(engine() % 120);
    // Small numbers more often than not: they get further.
    for (std::byte& b : payload) b = static_cast<std::byte>(engine() % (engine() % 2 ? 4 : 256));
    for (const ChunkType type : kTypes) {
      const Status status = test::read_chunk({type, payload, 50});
      if (!status) {
        ASSERT_THAT(status.error().message, HasSubstr("byte"));
      }
    }
  }
}

TEST(FormatDamage, RandomFiles) {
  std::mt19937 engine(2);
  const auto good = test::whole_file();
  for (int round = 0; round < 5000; ++round) {
    std::vector<std::byte> file(good.begin(), good.begin() + kHeaderSize);
    const std::size_t size = engine() % 200;
    for (std::size_t i = 0; i < size; ++i) file.push_back(static_cast<std::byte>(engine() % 9));
    const auto repaired = with_right_checksums(file);
    const Status status = read_all_chunks(repaired);
    if (!status) {
      ASSERT_THAT(status.error().message, HasSubstr("byte"));
    }
    const auto prefix = read_container_prefix(repaired);
    ASSERT_EQ(prefix && prefix->complete, read_container(repaired).has_value());
  }
}

}  // namespace
}  // namespace curlidar
