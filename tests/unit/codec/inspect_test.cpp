// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "curlidar/codec.hpp"
#include "format/container.hpp"

namespace curlidar {
namespace {

ByteSpan bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

TEST(Inspect, ListsChunksInFileOrder) {
  ContainerWriter writer;
  writer.add(ChunkType::metadata, bytes_of("12345"));
  writer.add(ChunkType::sensor, bytes_of("xyz"));
  const std::vector<std::byte> file = std::move(writer).finish();
  EXPECT_TRUE(is_curl(file));
  const auto chunks = list_chunks(file);
  ASSERT_TRUE(chunks) << chunks.error().message;
  ASSERT_EQ(chunks.value().size(), 2u);
  EXPECT_EQ(chunks.value()[0].name, "metadata");
  EXPECT_EQ(chunks.value()[0].bytes, 5u);
  EXPECT_EQ(chunks.value()[1].name, "sensor");
  EXPECT_EQ(file[chunks.value()[1].offset], std::byte{'x'});
}

TEST(Inspect, OtherBytesAreNoCurlFile) {
  EXPECT_FALSE(is_curl({}));
  EXPECT_FALSE(is_curl(bytes_of("# .PCD v0.7 - Point Cloud Data file format")));
  const auto chunks = list_chunks(bytes_of("ply\nformat ascii 1.0\n"));
  ASSERT_FALSE(chunks);
  EXPECT_EQ(chunks.error().code, ErrorCode::corrupt);
}

}  // namespace
}  // namespace curlidar
