// SPDX-License-Identifier: BSD-3-Clause
// Chunks of points with their ends cut off, bytes changed, or nothing but noise.
#include <gtest/gtest.h>

#include "hostile/targets/points.hpp"
#include "unit/records/random_points.hpp"

namespace curlidar {
namespace {

using Target = std::string (*)(ByteSpan);

/// Every cut and a few changes of every byte.
void damage(Target target, const std::vector<std::byte>& bytes) {
  ASSERT_EQ(target(bytes), "");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ASSERT_EQ(target(ByteSpan(bytes).first(size)), "") << "cut to " << size;
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const unsigned change : {0x01u, 0xffu}) {
      std::vector<std::byte> damaged = bytes;
      damaged[i] ^= static_cast<std::byte>(change);
      ASSERT_EQ(target(damaged), "") << "byte " << i << " changed by " << change;
    }
  }
}

/// Noise behind `head`, which the targets read as their header.
void feed_noise(Target target, const std::vector<std::byte>& head) {
  test::Random random(21);
  for (int i = 0; i < 40; ++i) {
    std::vector<std::byte> bytes = head;
    const std::size_t size = bytes.size() + random.next() % 60;
    while (bytes.size() < size) bytes.push_back(static_cast<std::byte>(random.next() & 0xff));
    ASSERT_EQ(target(bytes), "") << "noise " << i;
  }
}

std::vector<std::byte> bytes_of(std::initializer_list<unsigned> numbers) {
  std::vector<std::byte> bytes;
  for (const unsigned number : numbers) bytes.push_back(static_cast<std::byte>(number));
  return bytes;
}

void append(std::vector<std::byte>& to, const std::vector<std::byte>& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

TEST(PointsDamage, LoosePoints) {
  for (const ScalarType type : {ScalarType::float32, ScalarType::float64}) {
    const auto points = test::random_walk(type, {}, 0.1, 12);
    for (const double bound : {0.0, 0.01}) {
      damage(test::loose_target, encode_loose(points, type, {bound, 0})->bytes);
    }
  }
  damage(test::loose_target,
         encode_loose(std::vector<Vec3>(8, {1.25, 2, 1e6}), ScalarType::float64, {})->bytes);
  for (const unsigned kind : {0u, 1u, 2u, 3u}) {
    for (const unsigned type : {8u, 9u}) {
      feed_noise(test::loose_target, bytes_of({kind, type, 1, 40}));
      // Scales that no encoder would choose: the numbers must stay within bounds all the same.
      feed_noise(test::loose_target, bytes_of({kind, type, 0, 40, 0xe8, 0x03}));
      feed_noise(test::loose_target, bytes_of({kind, type, 0, 40, 0x18, 0xfc}));
      feed_noise(test::loose_target, bytes_of({kind, type, 0, 40, 1, 0, 0, 0, 0, 0, 0, 0}));
      feed_noise(test::loose_target,
                 bytes_of({kind, type, 0, 40, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xef, 0x7f}));
    }
  }
}

TEST(PointsDamage, Corrections) {
  const std::vector<Vec3> none(10);
  const auto points = test::random_walk(ScalarType::float32, {}, 0.1, 10);
  for (const double bound : {0.0, 0.01}) {
    std::vector<std::byte> bytes = bytes_of({10, 0});
    append(bytes, encode_corrections(none, points, ScalarType::float32, {bound})->bytes);
    damage(test::corrections_target, bytes);
  }
  for (const unsigned kind : {0u, 1u, 2u, 3u}) {
    for (const unsigned type : {8u, 9u}) {
      feed_noise(test::corrections_target, bytes_of({30, type, kind, type, 1, 30}));
      feed_noise(test::corrections_target, bytes_of({30, type, kind, type, 0, 30, 0xe8, 0x03}));
      feed_noise(test::corrections_target, bytes_of({30, type, kind, type, 0, 30, 0x18, 0xfc}));
    }
  }
}

TEST(PointsDamage, Directions) {
  std::vector<std::uint8_t> occupied(6 * 9, 1);
  const std::vector<std::int32_t> ranges(occupied.size(), 65536 * 4);
  std::vector<DirectionOffset> offsets(occupied.size());
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    offsets[i] = {static_cast<std::int32_t>(test::mixed(i) >> 8), static_cast<std::int32_t>(i)};
  }
  std::vector<std::byte> bytes = bytes_of({6, 9, 0});
  append(bytes, encode_directions({6, 9, occupied, 0}, ranges, offsets, 300).bytes);
  damage(test::directions_target, bytes);
  for (const unsigned fill : {0u, 2u, 3u, 0x3eu}) {
    feed_noise(test::directions_target, bytes_of({20, 40, fill}));
    feed_noise(test::directions_target, bytes_of({20, 40, fill, 0xff, 0xff, 0xff, 0x7f}));
  }
}

TEST(PointsDamage, ManyPointsClaimedByFewBytes) {
  // Bytes that say nothing: the reader stops when they are used up, before memory is.
  auto bytes = bytes_of({0, 8, 0, 0xff, 0xff, 0xff, 0xff, 0x0f, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f});
  const auto points = decode_loose({ChunkType::loose, bytes, 0}, SIZE_MAX);
  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().code, ErrorCode::corrupt);
}

}  // namespace
}  // namespace curlidar
