// SPDX-License-Identifier: BSD-3-Clause
#include "io/lzf.hpp"

#include <gtest/gtest.h>

#include "support/clouds.hpp"

namespace curlidar::io {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

void expect_round_trip(const std::vector<std::byte>& input) {
  const auto packed = lzf_compress(input);
  EXPECT_LE(packed.size(), input.size() * 33 / 32 + 1);
  const auto back = lzf_decompress(packed, input.size());
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, input);
}

TEST(Lzf, RoundTripsAnything) {
  test::Random random(7);
  for (std::size_t size : {0, 1, 2, 3, 4, 31, 32, 33, 64, 263, 264, 265, 300, 8191, 8200, 70000}) {
    for (const std::uint64_t alphabet : {1, 2, 5, 256}) {
      std::vector<std::byte> input(size);
      for (auto& b : input) b = static_cast<std::byte>(random.below(alphabet));
      expect_round_trip(input);
    }
  }
}

TEST(Lzf, MatchesReachExactlyTheLargestDistance) {
  for (const std::size_t distance : {8191, 8192, 8193}) {
    test::Random random(distance);
    std::vector<std::byte> input(distance);
    for (auto& b : input) b = static_cast<std::byte>(random.below(256));
    input.insert(input.end(), input.begin(), input.begin() + 100);
    expect_round_trip(input);
  }
}

TEST(Lzf, CompressesRepetition) {
  EXPECT_LT(lzf_compress(std::vector<std::byte>(26400)).size(), 310u);
}

TEST(Lzf, DecodesHandMadeStreams) {
  // Three literals; then 3 bytes from 3 back; then a run of the last byte, 2 + 7 + 1 = 10 long.
  const auto stream = bytes_of({2, 'a', 'b', 'c', 0x20, 2, 0xe0, 1, 0});
  const auto out = lzf_decompress(stream, 16);
  ASSERT_TRUE(out);
  EXPECT_EQ(*out, test::to_bytes("abcabccccccccccc"));
}

TEST(Lzf, RefusesDamage) {
  EXPECT_FALSE(lzf_decompress(bytes_of({2, 'a', 'b'}), 3));       // literals missing
  EXPECT_FALSE(lzf_decompress(bytes_of({0, 'a', 0x20, 1}), 4));   // before the start
  EXPECT_FALSE(lzf_decompress(bytes_of({0, 'a', 0x20}), 4));      // distance missing
  EXPECT_FALSE(lzf_decompress(bytes_of({0, 'a', 0xe0}), 4));      // length missing
  EXPECT_FALSE(lzf_decompress(bytes_of({0, 'a', 0x20, 0}), 3));   // gives more
  EXPECT_FALSE(lzf_decompress(bytes_of({0, 'a', 0x20, 0}), 5));   // gives less
  EXPECT_FALSE(lzf_decompress(bytes_of({0, 'a'}), 0xffffffffu));  // cannot give that many
  EXPECT_TRUE(lzf_decompress({}, 0));
}

}  // namespace
}  // namespace curlidar::io
