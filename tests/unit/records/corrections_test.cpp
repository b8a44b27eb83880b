// SPDX-License-Identifier: BSD-3-Clause
#include "records/corrections.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/records/random_points.hpp"

namespace curlidar {
namespace {

using test::Random;

Chunk chunk_of(ByteSpan bytes) {
  return {ChunkType::corrections, bytes, 0};
}

/// Encodes, applies, compares with what the encoder promised.
CodedCorrections round_trip(const std::vector<Vec3>& predicted, const std::vector<Vec3>& original,
                            ScalarType type, double bound) {
  auto coded = encode_corrections(predicted, original, type, {bound});
  EXPECT_TRUE(coded) << coded.error().message;
  if (!coded) return {};
  std::vector<Vec3> points = predicted;
  const Status applied = apply_corrections(chunk_of(coded->bytes), type, points);
  EXPECT_TRUE(applied) << applied.error().message;
  EXPECT_TRUE(test::same_bits(points, coded->decoded));
  return *coded;
}

/// Every third point far off, every third a little, the others right.
std::vector<Vec3> disturbed(const std::vector<Vec3>& points, ScalarType type) {
  Random random(9);
  std::vector<Vec3> moved = points;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const double by = i % 3 == 0 ? 0.3 : i % 3 == 1 ? 0.003 : 0;
    const Vec3 offset = Vec3{random.uniform(), random.uniform(), random.uniform()} * by;
    const Vec3 to = test::of_type(type, moved[i] + offset);
    if (std::isfinite(to.x + to.y + to.z)) moved[i] = to;
  }
  return moved;
}

class CorrectedClouds : public testing::TestWithParam<test::CloudCase> {};

TEST_P(CorrectedClouds, ComeBackBitForBit) {
  for (const ScalarType type : {ScalarType::float32, ScalarType::float64}) {
    const std::vector<Vec3> points = GetParam().make(type);
    EXPECT_TRUE(
        test::same_bits(round_trip(disturbed(points, type), points, type, 0).decoded, points));
    const std::vector<Vec3> nothing(points.size());
    EXPECT_TRUE(test::same_bits(round_trip(nothing, points, type, 0).decoded, points));
  }
}

TEST_P(CorrectedClouds, ComeBackWithinEveryBound) {
  for (const ScalarType type : {ScalarType::float32, ScalarType::float64}) {
    const std::vector<Vec3> points = GetParam().make(type);
    for (const double bound : {1e-6, 0.002, 0.05, 3.0}) {
      const CodedCorrections coded = round_trip(disturbed(points, type), points, type, bound);
      for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_LE(norm(coded.decoded[i] - points[i]), bound) << "point " << i;
        EXPECT_TRUE(test::is_of(type, coded.decoded[i])) << "point " << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, CorrectedClouds, testing::ValuesIn(test::kCloudCases),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Corrections, KeepPredictionsThatAreGoodEnough) {
  const std::vector<Vec3> points = test::random_walk(ScalarType::float32, {}, 0.1, 2000);
  std::vector<Vec3> predicted = points;
  predicted[700].x += 0.5;
  predicted[701].y += 0.0625;
  predicted = {predicted.begin(), predicted.end()};
  for (Vec3& p : predicted) p = test::of_type(ScalarType::float32, p);
  const CodedCorrections coded = round_trip(predicted, points, ScalarType::float32, 0.1);
  EXPECT_EQ(coded.corrected, 1u);
  EXPECT_EQ(coded.decoded[701], predicted[701]);
  EXPECT_LT(coded.bytes.size(), 50u);
}

TEST(Corrections, MillimetresCostWhatTheirMissesTell) {
  const ScalarType type = ScalarType::float32;
  Random random(7);
  std::vector<Vec3> original, predicted;
  for (int i = 0; i < 20000; ++i) {
    Vec3 from, to;
    for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      const double exact = 40 * random.uniform();
      to.*axis = std::floor(exact * 1000 + 0.5) / 1000;
      from.*axis = exact + 0.00003 * random.uniform();
    }
    original.push_back(test::of_type(type, to));
    predicted.push_back(test::of_type(type, from));
  }
  const CodedCorrections coded = round_trip(predicted, original, type, 0);
  EXPECT_TRUE(test::same_bits(coded.decoded, original));
  EXPECT_LT(static_cast<double>(coded.bytes.size()) * 8 / 20000, 0.4);
}

TEST(Corrections, AnExactPredictionCostsNothing) {
  const std::vector<Vec3> points = test::random_walk(ScalarType::float64, {}, 0.1, 5000);
  const CodedCorrections coded = round_trip(points, points, ScalarType::float64, 0);
  EXPECT_EQ(coded.corrected, 0u);
  EXPECT_LT(coded.bytes.size(), 60u);
}

TEST(Corrections, NoReturnBecomesTheOrigin) {
  const std::vector<Vec3> original{{0.001, 0, 0}, {}};
  const CodedCorrections coded =
      round_trip(std::vector<Vec3>(2), original, ScalarType::float64, 0.5);
  EXPECT_NE(coded.decoded[0], Vec3{});
  EXPECT_EQ(coded.decoded[1], Vec3{});
}

TEST(Corrections, TellWhatTheyCannotTake) {
  const std::vector<Vec3> one(1), two(2), wide{{0.1, 0, 0}}, none{{std::nan(""), 0, 0}};
  const auto refused = [](const std::vector<Vec3>& predicted, const std::vector<Vec3>& original,
                          ScalarType type, double bound) {
    const auto coded = encode_corrections(predicted, original, type, {bound});
    return !coded && coded.error().code == ErrorCode::invalid_argument;
  };
  EXPECT_TRUE(refused(one, two, ScalarType::float32, 0));
  EXPECT_TRUE(refused(one, wide, ScalarType::float32, 0));
  EXPECT_TRUE(refused(wide, one, ScalarType::float32, 0.1));
  EXPECT_TRUE(refused(one, none, ScalarType::float64, 0));
  EXPECT_TRUE(refused(one, one, ScalarType::uint8, 0));
  EXPECT_TRUE(refused(one, one, ScalarType::float32, -1));
}

TEST(Corrections, AreForTheirPointsOnly) {
  const std::vector<Vec3> points = test::random_walk(ScalarType::float32);
  const auto coded = encode_corrections(points, points, ScalarType::float32, {});
  std::vector<Vec3> fewer(points.begin(), points.end() - 1), more = points;
  more.emplace_back();
  EXPECT_FALSE(apply_corrections(chunk_of(coded->bytes), ScalarType::float32, fewer));
  EXPECT_FALSE(apply_corrections(chunk_of(coded->bytes), ScalarType::float32, more));
  more.pop_back();
  EXPECT_FALSE(apply_corrections(chunk_of(coded->bytes), ScalarType::float64, more));
  EXPECT_TRUE(apply_corrections(chunk_of(coded->bytes), ScalarType::float32, more));
}

}  // namespace
}  // namespace curlidar
