// SPDX-License-Identifier: BSD-3-Clause
// What a scan makes expect of the next: against the same in floating point, and at rest.
#include "compact/prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "compact/cell_finder.hpp"
#include "compact/prediction_chunk.hpp"
#include "support/compact_scans.hpp"

namespace curlidar::compact {
namespace {

DecodedScan decoded_street(std::uint32_t rows = 24, std::uint32_t columns = 256) {
  const test::CompactScan street = test::integer_street(rows, columns);
  ScanSettings settings;
  settings.steps = steps_for_step(kRangeUnit / 5);
  settings.effort = 1;
  const auto encoded = encode_scan(street.image, street.table, settings);
  EXPECT_TRUE(encoded);
  auto decoded = decode_scan(test::views_of(encoded->chunks));
  EXPECT_TRUE(decoded);
  return *std::move(decoded);
}

TEST(Prediction, AzimuthsAreThoseOfTheArcTangent) {
  for (int i = 0; i < 5000; ++i) {
    const double angle = i * 0.00125664;
    const double r = 3000.0 + 9000.0 * (i % 700) * (i % 700);
    const auto x = std::llround(r * std::cos(angle)), y = std::llround(r * std::sin(angle));
    const double turns =
        std::atan2(static_cast<double>(y), static_cast<double>(x)) / (2 * std::numbers::pi);
    const double found = static_cast<double>(static_cast<std::int32_t>(azimuth_of(x, y))) / 0x1p32;
    const double apart = std::remainder(found - turns, 1.0);
    ASSERT_LT(std::abs(apart), 0x1p-20) << x << " " << y;
  }
  EXPECT_EQ(azimuth_of(0, 0), 0u);
  EXPECT_NEAR(azimuth_of(0, 5), 0x1p30, 0x1p12);
  EXPECT_NEAR(azimuth_of(-5, 0), 0x1p31, 0x1p12);
}

TEST(Prediction, EveryCellSeesThePlacesOnItsOwnLine) {
  const test::CompactScan street = test::integer_street(24, 256);
  const CellFinder finder(street.table, 24, 256);
  const Sights sights(street.table, 24, 256);
  for (std::size_t cell = 0; cell < 24 * 256; ++cell) {
    const Sight sight = sights.at(cell);
    const std::int64_t r = (3 + static_cast<std::int64_t>(cell % 60)) * kRangeUnit;
    const Place place{(r * sight.direction.x) >> 22, (r * sight.direction.y) >> 22,
                      (r * sight.direction.z) >> 22};
    ASSERT_EQ(finder.cell_of(place), static_cast<std::int64_t>(cell));
  }
}

TEST(Prediction, AtRestEveryReturnIsExpectedWhereItWas) {
  const DecodedScan scan = decoded_street();
  const Prediction at_rest = predict(scan, {}, scan.table, 24, 256);
  for (std::size_t cell = 0; cell < scan.range.size(); ++cell) {
    ASSERT_EQ(at_rest.was_there[cell], scan.range[cell] > 0 ? 1 : 0);
    if (scan.range[cell] <= 0) continue;
    ASSERT_EQ(at_rest.level[cell], 0);
    ASSERT_LE(std::abs(at_rest.range[cell] - scan.range[cell]), 64) << cell;
  }
}

TEST(Prediction, MovedReturnsLieWhereRealNumbersHaveThem) {
  const DecodedScan scan = decoded_street();
  RelativePose pose;
  pose.turn = {0, 0, 1 << 14};           // 1/64 rad about z
  pose.move = {-(1 << 10), 1 << 8, 40};  // half a metre back, an eighth to the left
  const Prediction moved = predict(scan, pose, scan.table, 24, 256);
  const Sights sights(scan.table, 24, 256);
  const double yaw = 1.0 / 64, c = std::cos(yaw), s = std::sin(yaw);
  std::size_t expected = 0, found = 0;
  for (std::size_t cell = 0; cell < scan.range.size(); ++cell) {
    if (scan.range[cell] <= 0) continue;
    const Direction d = sights.at(cell).direction;
    const double r = static_cast<double>(scan.range[cell]) / kRangeUnit / (1 << 22);
    const double x = c * d.x * r - s * d.y * r - 0.5, y = s * d.x * r + c * d.y * r + 0.125,
                 z = d.z * r + 40.0 / 2048;
    const double level = std::hypot(x, y), range = std::hypot(level, z);
    const double column = std::fmod((std::atan2(y, x) / (2 * std::numbers::pi) + 0.5) * 256, 256);
    const auto j = static_cast<std::size_t>(std::llround(column)) % 256;
    std::size_t row = 0;
    for (std::size_t k = 1; k < 24; ++k) {
      const auto apart = [&](std::size_t i) {
        return std::abs(level * std::tan(scan.table.elevation[i] * std::numbers::pi / 0x1p31) - z);
      };
      if (apart(k) < apart(row)) row = k;
    }
    const double up = std::atan2(z, level) * 0x1p31 / std::numbers::pi;
    if (up > scan.table.elevation[0] || up < scan.table.elevation[23]) continue;
    ++expected;
    const std::size_t to = row * 256 + j;
    // What is nearer may hide it.
    if (moved.level[to] == 0 && moved.range[to] <= 1.1 * range * kRangeUnit) ++found;
  }
  EXPECT_GT(expected, 2000u);
  EXPECT_GE(found, expected * 99 / 100);
}

TEST(Prediction, AnyPoseAndAnySizeIsWalkedThrough) {
  const DecodedScan scan = decoded_street(16, 64);
  for (const std::int32_t turn : {-RelativePose::kMostTurn, 12345, RelativePose::kMostTurn}) {
    for (const std::int32_t move : {-RelativePose::kMostMove, 0, RelativePose::kMostMove}) {
      RelativePose pose;
      pose.turn = {turn, -turn, turn};
      pose.move = {move, move, -move};
      const test::CompactScan other = test::integer_street(1, 7);
      EXPECT_EQ(predict(scan, pose, other.table, 1, 7).source.size(), 7u);
      EXPECT_EQ(predict(scan, pose, scan.table, 16, 64).source.size(), 16u * 64);
    }
  }
}

TEST(PredictionChunk, ComesBackAndRefusesWhatItDoesNotKnow) {
  PredictionHeader header;
  header.pose.turn = {5, -70000, 0};
  header.pose.move = {-1, 1 << 20, RelativePose::kMostMove};
  header.same_rows = true;
  header.reference = 0xbeef;
  std::vector<std::byte> bytes = write_prediction(header);
  const auto back = read_prediction({ScanPart::prediction, bytes, 0, true});
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, header);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(read_prediction({ScanPart::prediction, ByteSpan(bytes).first(size), 0, true}));
  }
  bytes.push_back(std::byte{0});
  EXPECT_EQ(read_prediction({ScanPart::prediction, bytes, 0, true}).error().code,
            ErrorCode::corrupt);
  for (const int flags : {0x08, 0x80, 0x04}) {
    bytes[0] = static_cast<std::byte>(flags);
    EXPECT_FALSE(read_prediction({ScanPart::prediction, bytes, 0, true}));
  }
}

}  // namespace
}  // namespace curlidar::compact
