// SPDX-License-Identifier: BSD-3-Clause
// The compact field between its cells.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "curlidar/reconstruct.hpp"
#include "support/scans.hpp"

namespace curlidar {
namespace {

/// A sensor in the middle of a round room of 8 m, with a pillar 3 m away, 24 rings x 256.
Cloud round_room(bool pillar) {
  const SensorProfile sensor = test::small_sensor();
  const Lattice lattice = Lattice::from_rings(sensor.elevations(), 256);
  Cloud cloud;
  cloud.width = 256;
  cloud.height = lattice.rows();
  for (std::uint32_t row = 0; row < lattice.rows(); ++row) {
    for (std::uint32_t column = 0; column < 256; ++column) {
      const double radius = pillar && column >= 100 && column < 120 ? 3 : 8;
      cloud.positions.push_back(lattice.direction(row, column) *
                                (radius / std::cos(lattice.elevation(row))));
    }
  }
  return cloud;
}

DecodedScan coded(const Cloud& cloud, double error_m) {
  EncodeSettings settings;
  settings.compact.target_value = error_m;
  settings.compact.effort = 2;
  return decode(encode(cloud, settings)->bytes).value();
}

double range_at(const Field& field, double row, double column, bool masked = true) {
  std::array<double, 1> range{};
  field.evaluate_row(row, std::array{column}, masked, range);
  return range[0];
}

TEST(CompactField, RowsWithoutReturnsTakeTheNearestRow) {
  const SensorProfile sensor = test::small_sensor();
  Cloud cloud = round_room(false);
  for (std::uint32_t row = 0; row < cloud.height; ++row) {
    for (std::uint32_t column = 0; column < cloud.width; ++column) {
      Vec3& point = cloud.positions[std::size_t{row} * cloud.width + column];
      point = row == 3 ? point * 0.5 : row == 21 ? point : Vec3{};
    }
  }
  EncodeSettings settings;
  settings.sensor = sensor;
  settings.compact.coverage = Coverage::image;
  settings.compact.target_value = 0.01;
  const auto scan = decode(encode(cloud, settings)->bytes);
  ASSERT_EQ(scan->field->lattice().rows(), 24u);
  for (const auto& [row, from] : {std::pair{0, 3}, {11, 3}, {12, 3}, {13, 21}, {23, 21}}) {
    EXPECT_EQ(range_at(*scan->field, row, 40, false), range_at(*scan->field, from, 40)) << row;
    EXPECT_TRUE(std::isnan(range_at(*scan->field, row, 40)));
  }
}

TEST(CompactField, CellsHaveTheirCodedRangesLessTheOffsetsOfRings) {
  for (const double error : {0.05, 0.005}) {  // without and with residuals
    const DecodedScan scan = coded(test::small_scan(), error);
    const Lattice& lattice = scan.field->lattice();
    std::size_t number = 0;
    for (std::uint32_t row = 0; row < lattice.rows(); ++row) {
      for (std::uint32_t column = 0; column < lattice.columns(); ++column) {
        const double range = range_at(*scan.field, row, column);
        ASSERT_EQ(std::isnan(range), !scan.field->occupied(row, column));
        if (std::isnan(range)) continue;
        ASSERT_NEAR(range + scan.field->ring_offset_m(row), norm(scan.points[number]),
                    1e-7 * range);
        ++number;
      }
    }
    EXPECT_EQ(number, scan.points.size());
  }
}

TEST(CompactField, StaysOnTheWallBetweenCells) {
  const DecodedScan scan = coded(round_room(false), 0.01);
  const Cloud dense = reconstruct(scan, {.rows = 4, .columns = 3}).value();
  EXPECT_GT(dense.size(), 11 * scan.points.size());
  for (const Vec3& p : dense.positions) ASSERT_NEAR(std::hypot(p.x, p.y), 8, 0.15);
}

TEST(CompactField, DirectionsBetweenAPillarAndTheWallAreNotBelieved) {
  const DecodedScan scan = coded(round_room(true), 0.01);
  for (const double column : {99.5, 119.5}) {
    EXPECT_TRUE(std::isnan(range_at(*scan.field, 12.25, column)));
    EXPECT_FALSE(std::isnan(range_at(*scan.field, 12.25, column, false)));
  }
  EXPECT_NEAR(range_at(*scan.field, 12.25, 110.5), 3, 0.2);
  EXPECT_NEAR(range_at(*scan.field, 12.25, 60.5), 8, 0.4);
}

TEST(CompactField, EmptyCellsHoldNothingButWithoutMasksEveryDirectionDoes) {
  Cloud room = round_room(false);
  for (std::size_t row = 0; row < room.height; ++row) {
    for (std::size_t column = 40; column < 60; ++column) room.positions[row * 256 + column] = {};
  }
  const DecodedScan scan = coded(room, 0.01);
  const Field& field = *scan.field;
  EXPECT_TRUE(std::isnan(range_at(field, 5.5, 50.25)));
  EXPECT_FALSE(std::isnan(range_at(field, 5.5, 39.4)));  // nearer to what is coded
  EXPECT_TRUE(std::isnan(range_at(field, 5.5, 39.6)));
  EXPECT_NEAR(range_at(field, 5.5, 50.25, false), 8, 0.6);
  EXPECT_NEAR(range_at(field, -0.5, 200.5, false), 8, 0.6);
  const Cloud all = reconstruct(scan, {.masks = false, .strategy = DenseStrategy::masks}).value();
  EXPECT_EQ(all.size(), field.lattice().cells());
}

TEST(CompactField, SaysNothingOfPlacesThatAreNone) {
  const DecodedScan scan = coded(round_room(false), 0.01);
  const double nan = std::nan(""), infinite = HUGE_VAL;
  for (const auto& [row, column] : {std::pair{7.5, nan}, {7.5, infinite}, {nan, 3.0}}) {
    EXPECT_TRUE(std::isnan(range_at(*scan.field, row, column, true)));
    EXPECT_TRUE(std::isnan(range_at(*scan.field, row, column, false)));
    EXPECT_LT(scan.field->nearest_cell(row, column), scan.field->lattice().cells());
  }
  EXPECT_NEAR(range_at(*scan.field, 7.5, 1e300), 8, .6);
}

TEST(CompactField, WrapsAroundTheTurn) {
  const DecodedScan scan = coded(round_room(false), 0.01);
  for (const double column : {0.25, 255.75}) {
    const double range = range_at(*scan.field, 7.5, column);
    EXPECT_NEAR(range, range_at(*scan.field, 7.5, column + 256), 1e-6);
    EXPECT_NEAR(range, range_at(*scan.field, 7.5, column - 256), 1e-6);
  }
}

TEST(CompactField, BeamsAwayFromTheOriginKeepTheirHeights) {
  SensorProfile sensor = test::small_sensor();
  Cloud scan;
  for (Ring& ring : sensor.rings) {
    ring.vertical_offset_m = 0.2;
    for (std::uint32_t column = 0; column < 256; ++column) {
      // Eight walls, 4 m to 39 m away.
      const double azimuth = -std::numbers::pi + 2 * std::numbers::pi * column / 256;
      const double away = 4 + 5 * (column / 32);
      scan.positions.push_back({away * std::cos(azimuth), away * std::sin(azimuth),
                                0.2 + away * std::tan(ring.elevation)});
    }
  }
  scan.width = static_cast<std::uint32_t>(scan.size());
  EncodeSettings settings;
  settings.sensor = sensor;
  settings.compact.effort = 1;
  settings.compact.columns = 256;
  settings.compact.target_value = 0.01;
  const Encoded encoded = encode(scan, settings).value();
  ASSERT_TRUE(encoded.report.compact->heights);
  EXPECT_EQ(encoded.report.points_coded, scan.size());
  const DecodedScan decoded = decode(encoded.bytes).value();
  const Field& field = *decoded.field;
  // Half-way between two rings, a point lies half-way between theirs.
  for (const double column : {16., 112., 240.}) {
    const double away = 4 + 5 * std::floor(column / 32);
    const std::array range{range_at(field, 10.5, column)};
    std::array<Vec3, 1> point;
    field.place_row(10.5, std::array{column}, range, point);
    const double middle = (sensor.rings[10].elevation + sensor.rings[11].elevation) / 2;
    EXPECT_NEAR(point[0].z, 0.2 + away * std::tan(middle), 0.02);
    EXPECT_NEAR(norm(point[0]), range[0], 1e-9);
  }
}

}  // namespace
}  // namespace curlidar
