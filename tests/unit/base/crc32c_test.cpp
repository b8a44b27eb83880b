// SPDX-License-Identifier: BSD-3-Clause
#include "base/crc32c.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string_view>

namespace curlidar {
namespace {

template <class Values>
std::uint32_t checksum(const Values& values) {
  return crc32c(std::as_bytes(std::span(values)));
}

// The vectors of RFC 3720, appendix B.4.
TEST(Crc32c, PublishedVectors) {
  std::array<std::uint8_t, 32> block{};
  EXPECT_EQ(checksum(block), 0x8a9136aau);
  block.fill(0xff);
  EXPECT_EQ(checksum(block), 0x62a8ab43u);
  for (std::size_t i = 0; i < block.size(); ++i) block[i] = static_cast<std::uint8_t>(i);
  EXPECT_EQ(checksum(block), 0x46dd794eu);
  for (std::size_t i = 0; i < block.size(); ++i) block[i] = static_cast<std::uint8_t>(31 - i);
  EXPECT_EQ(checksum(block), 0x113fdb5cu);
  const std::array<std::uint8_t, 48> iscsi_read{
      0x01, 0xc0, 0, 0,    0, 0, 0, 0,    0,    0, 0, 0, 0, 0, 0, 0, 0x14, 0, 0, 0, 0, 0, 0x04, 0,
      0,    0,    0, 0x14, 0, 0, 0, 0x18, 0x28, 0, 0, 0, 0, 0, 0, 0, 0x02, 0, 0, 0, 0, 0, 0,    0};
  EXPECT_EQ(checksum(iscsi_read), 0xd9963a56u);
  EXPECT_EQ(checksum(std::string_view("123456789")), 0xe3069283u);
  EXPECT_EQ(checksum(std::string_view("")), 0u);
}

TEST(Crc32c, ContinuesAtAnyCut) {
  std::array<std::uint8_t, 61> block{};
  for (std::size_t i = 0; i < block.size(); ++i) block[i] = static_cast<std::uint8_t>(i * 37);
  const ByteSpan bytes = std::as_bytes(std::span(block));
  const std::uint32_t whole = crc32c(bytes);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    EXPECT_EQ(crc32c(bytes.subspan(cut), crc32c(bytes.first(cut))), whole) << "cut at " << cut;
  }
}

}  // namespace
}  // namespace curlidar
