// SPDX-License-Identifier: BSD-3-Clause
#include "records/directions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "unit/records/random_points.hpp"

namespace curlidar {
namespace {

using test::Random;

constexpr double kAngle = 6.283185307179586 / 4294967296;  // radians

/// An image and the offsets of its occupied cells.
struct Image {
  std::uint32_t rows = 16, columns = 300;
  std::vector<std::uint8_t> occupied;
  std::vector<std::int32_t> ranges;
  std::vector<DirectionOffset> offsets;

  CellGrid grid() const { return {rows, columns, occupied, 0}; }
};

/// `offset(row, column)` of about 7 in 8 cells, at ranges from 1 m to 61 m.
template <class Offset>
Image image_of(const Offset& offset) {
  Image image;
  Random random(11);
  for (std::uint32_t row = 0; row < image.rows; ++row) {
    for (std::uint32_t column = 0; column < image.columns; ++column) {
      image.occupied.push_back(random.next() % 8 != 0);
      if (image.occupied.back() == 0) continue;
      image.ranges.push_back(static_cast<std::int32_t>((31 + 30 * random.uniform()) * 65536));
      image.offsets.push_back(offset(row, column));
    }
  }
  return image;
}

CodedDirections round_trip(const Image& image, std::int32_t step) {
  CodedDirections coded = encode_directions(image.grid(), image.ranges, image.offsets, step);
  const auto decoded =
      decode_directions({ChunkType::directions, coded.bytes, 0}, image.grid(), image.ranges);
  EXPECT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(decoded && *decoded == coded.decoded);
  return coded;
}

double bits_a_cell(const Image& image, const CodedDirections& coded) {
  return static_cast<double>(coded.bytes.size()) * 8 / static_cast<double>(image.offsets.size());
}

Image random_image() {
  Random random(12);
  const auto any = [&random] { return static_cast<std::int32_t>(7000000 * random.uniform()); };
  return image_of([&any](std::uint32_t, std::uint32_t) { return DirectionOffset{any(), any()}; });
}

TEST(Directions, LieWithinHalfAStep) {
  const Image image = random_image();
  for (const std::int32_t step : {1, 65, 655, 6554, 1 << 20}) {
    const CodedDirections coded = round_trip(image, step);
    ASSERT_EQ(coded.decoded.size(), image.offsets.size());
    for (std::size_t i = 0; i < coded.decoded.size(); ++i) {
      // Twice 2^-16 m: a step is a whole number of binary angles, at least one.
      const double most = (step / 2.0 + 2) / image.ranges[i] / kAngle;
      EXPECT_LE(std::abs(coded.decoded[i].across - image.offsets[i].across), most);
      EXPECT_LE(std::abs(coded.decoded[i].up - image.offsets[i].up), most);
    }
  }
}

TEST(Directions, OffsetsSmallerThanTheStepCostNothing) {
  const Image image = random_image();
  const CodedDirections coded = round_trip(image, 1 << 24);
  EXPECT_LT(coded.bytes.size(), 40u);
  for (const DirectionOffset& offset : coded.decoded) EXPECT_EQ(offset, DirectionOffset{});
}

TEST(Directions, ASteadyDriftThroughTheCellsCostsLittle) {
  const std::int64_t cell = (std::int64_t{1} << 32) / 300;
  const Image image = image_of([&](std::uint32_t row, std::uint32_t column) {
    const std::int64_t drift = std::int64_t{column} * 123457 % cell - cell / 2;
    return DirectionOffset{static_cast<std::int32_t>(drift), static_cast<std::int32_t>(row) * 1000};
  });
  EXPECT_LT(bits_a_cell(image, round_trip(image, 655)), 2);
}

TEST(Directions, TakeAnyOffset) {
  Image image = random_image();
  image.offsets[3] = {INT32_MIN, INT32_MAX};
  image.offsets[4] = {INT32_MAX, INT32_MIN};
  image.ranges[3] = 1;
  image.ranges[4] = 1 << 30;
  for (const std::int32_t step : {1, 1000, 1 << 30}) round_trip(image, step);
}

TEST(Directions, OfNoCells) {
  const CellGrid grid{0, 0, {}, 5};
  const CodedDirections coded = encode_directions(grid, {}, {}, 10);
  const auto decoded = decode_directions({ChunkType::directions, coded.bytes, 0}, grid, {});
  ASSERT_TRUE(decoded);
  EXPECT_TRUE(decoded->empty());
}

TEST(Directions, RefuseAStepOfZeroOrTooLarge) {
  const CellGrid grid{0, 0, {}, 0};
  for (const std::uint64_t step : {std::uint64_t{0}, (std::uint64_t{1} << 30) + 1}) {
    ByteWriter writer;
    writer.write_varint(step);
    const auto decoded = decode_directions({ChunkType::directions, writer.bytes(), 0}, grid, {});
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error().code, ErrorCode::corrupt);
  }
}

}  // namespace
}  // namespace curlidar
