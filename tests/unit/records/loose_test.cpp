// SPDX-License-Identifier: BSD-3-Clause
#include "records/loose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "unit/records/random_points.hpp"

namespace curlidar {
namespace {

using test::Random;

Chunk chunk_of(ByteSpan bytes) {
  return {ChunkType::loose, bytes, 0};
}

/// Encodes, decodes, compares with what the encoder promised.
CodedPoints round_trip(const std::vector<Vec3>& points, ScalarType type,
                       const LooseSettings& settings) {
  auto coded = encode_loose(points, type, settings);
  EXPECT_TRUE(coded) << coded.error().message;
  if (!coded) return {};
  const auto decoded = decode_loose(chunk_of(coded->bytes), points.size());
  EXPECT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(decoded && test::same_bits(*decoded, coded->decoded));
  EXPECT_EQ(coded->decoded.size(), points.size());
  return *coded;
}

void expect_exact(const std::vector<Vec3>& points, ScalarType type) {
  EXPECT_TRUE(test::same_bits(round_trip(points, type, {}).decoded, points));
}

void expect_within(const std::vector<Vec3>& points, ScalarType type, double bound) {
  const CodedPoints coded = round_trip(points, type, {bound, 0});
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE(norm(coded.decoded[i] - points[i]), bound) << "point " << i;
    EXPECT_EQ(coded.decoded[i] == Vec3{}, points[i] == Vec3{}) << "point " << i;
    EXPECT_TRUE(test::is_of(type, coded.decoded[i])) << "point " << i;
  }
}

class LooseClouds : public testing::TestWithParam<test::CloudCase> {};

TEST_P(LooseClouds, ComeBackBitForBit) {
  for (const ScalarType type : {ScalarType::float32, ScalarType::float64}) {
    expect_exact(GetParam().make(type), type);
  }
}

TEST_P(LooseClouds, ComeBackWithinEveryBound) {
  for (const ScalarType type : {ScalarType::float32, ScalarType::float64}) {
    const std::vector<Vec3> points = GetParam().make(type);
    for (const double bound : {1e-6, 0.002, 0.05, 3.0, 1e6}) expect_within(points, type, bound);
  }
}

INSTANTIATE_TEST_SUITE_P(All, LooseClouds, testing::ValuesIn(test::kCloudCases),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Loose, StepQuantisesToTheNearestMultiple) {
  const auto points = test::random_walk(ScalarType::float64);
  const CodedPoints coded = round_trip(points, ScalarType::float64, {0, 0.5});
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (coded.decoded[i] == points[i]) continue;  // told raw: its multiple is the origin
    EXPECT_EQ(coded.decoded[i].x, std::floor(points[i].x / 0.5 + 0.5) * 0.5);
    EXPECT_EQ(coded.decoded[i].z, std::floor(points[i].z / 0.5 + 0.5) * 0.5);
  }
}

TEST(Loose, MillimetresCostFarLessThanTheirBits) {
  std::vector<Vec3> points;
  Random random(5);
  for (int i = 0; i < 4000; ++i) {
    const double angle = i * 0.003, range = 20 + std::sin(angle * 5) + 0.01 * random.uniform();
    const auto millimetres = [](double x) { return std::floor(x * 1000 + 0.5) / 1000; };
    points.push_back(test::of_type(
        ScalarType::float32, {millimetres(range * std::cos(angle)),
                              millimetres(range * std::sin(angle)), millimetres(range * 0.1)}));
  }
  const CodedPoints coded = round_trip(points, ScalarType::float32, {});
  EXPECT_TRUE(test::same_bits(coded.decoded, points));
  EXPECT_LT(static_cast<double>(coded.bytes.size()) * 8 / 4000, 10);
}

TEST(Loose, ARepeatedLineCostsLittle) {
  std::vector<Vec3> points;
  for (int line = 0; line < 40; ++line) {
    for (int i = 0; i < 100; ++i) points.push_back({i * 0.1, line * 0.125, std::sin(i * 0.4)});
  }
  const CodedPoints coded = round_trip(points, ScalarType::float64, {0.02, 0});
  EXPECT_LT(static_cast<double>(coded.bytes.size()) * 8 / 4000, 1.5);
}

TEST(Loose, TellsWhatItCannotTake) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refused = [](const std::vector<Vec3>& points, ScalarType type,
                          const LooseSettings& settings) {
    const auto coded = encode_loose(points, type, settings);
    return !coded && coded.error().code == ErrorCode::invalid_argument;
  };
  EXPECT_TRUE(refused({{infinity, 0, 0}}, ScalarType::float64, {}));
  EXPECT_TRUE(refused({{std::nan(""), 0, 0}}, ScalarType::float32, {0.1, 0}));
  EXPECT_TRUE(refused({{1e300, 0, 0}}, ScalarType::float32, {}));
  EXPECT_TRUE(refused({{0.1, 0.1, 0.1}}, ScalarType::float32, {}));
  EXPECT_TRUE(refused({{1, 0, 0}}, ScalarType::int32, {}));
  EXPECT_TRUE(refused({{1, 0, 0}}, ScalarType::float32, {-1, 0}));
  EXPECT_TRUE(refused({{1, 0, 0}}, ScalarType::float32, {0, infinity}));
}

TEST(Loose, RefusesMorePointsThanAllowed) {
  const auto coded = encode_loose(test::random_walk(ScalarType::float32), ScalarType::float32, {});
  const auto decoded = decode_loose(chunk_of(coded->bytes), 10);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, ErrorCode::limit_exceeded);
}

TEST(Loose, MortonOrderIsAPermutationThatKeepsNeighboursTogether) {
  const std::vector<Vec3> points{{0, 0, 0}, {100, 100, 100}, {1, 0, 0}, {99, 100, 100}};
  EXPECT_EQ(morton_order(points), (std::vector<std::uint32_t>{0, 2, 3, 1}));
  EXPECT_TRUE(morton_order({}).empty());
  EXPECT_EQ(morton_order(std::vector<Vec3>{{1, 2, 3}, {1, 2, 3}}),
            (std::vector<std::uint32_t>{0, 1}));
  const double most = std::numeric_limits<double>::max();
  EXPECT_EQ(morton_order(std::vector<Vec3>{{most, 0, 0}, {-most, 0, 0}}),
            (std::vector<std::uint32_t>{1, 0}));
}

}  // namespace
}  // namespace curlidar
