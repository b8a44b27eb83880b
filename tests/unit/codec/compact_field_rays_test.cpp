// SPDX-License-Identifier: BSD-3-Clause
// The field of files coded on a sensor's own rays: in a box whose walls are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "codec/beam_tables.hpp"
#include "codec/compact_field.hpp"
#include "compact/scan_encoder.hpp"
#include "compact/scan_points.hpp"
#include "curlidar/reconstruct.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/io.hpp"
#include "support/data.hpp"
#include "unit/sensor/lattice_scans.hpp"

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Half sizes of the room and depth of its ground: so near that rays which start 2.6 cm beside the
/// axis hit it three columns away.
constexpr double kWallX = 3, kWallY = 2.5, kGround = 1.7;

double away_from_room(const Vec3& p) {
  return std::min({std::abs(std::abs(p.x) - kWallX), std::abs(std::abs(p.y) - kWallY),
                   std::abs(p.z + kGround)});
}

/// Length of a ray from its start to the room.
double cast(const Vec3& o, const Vec3& d) {
  double length = d.z < 0 ? (-kGround - o.z) / d.z : 1e9;
  if (d.x != 0) length = std::min(length, (std::copysign(kWallX, d.x) - o.x) / d.x);
  if (d.y != 0) length = std::min(length, (std::copysign(kWallY, d.y) - o.y) / d.y);
  return length;
}

struct RayScan {
  compact::RowTable table;
  compact::DecodedScan decoded;
  std::vector<Vec3> points;  ///< coded returns in raster order
};

struct RoomOptions {
  double error_m = .01;
  double occupancy = .95;
  MotionTwist motion{};
  std::uint32_t gap_begin = 0, gap_end = 0;  ///< encoder positions without a firing
};

LatticeFit fit_of(const RoomOptions& options) {
  LatticeFit fit;
  fit.beams = test::two_blocks();
  fit.motion = options.motion;
  for (std::uint32_t position = 0; position < fit.beams.slots; position += 2) {
    // Unevenly, as an encoder has it.
    const std::uint32_t at = position + (position % 14 == 0 ? 1 : 0);
    if (at < options.gap_begin || at >= options.gap_end) fit.firings.push_back(at);
  }
  return fit;
}

compact::Image image_of_room(const compact::RowTable& table, double occupancy) {
  const compact::RayTable& rays = *table.rays;
  compact::Image image{static_cast<std::uint32_t>(rays.rays.size()), table.turn_columns, {}};
  test::Random random(9);
  for (std::uint32_t row = 0; row < image.rows; ++row) {
    const compact::Ray& ray = rays.rays[row];
    const double elevation = radians_from_angle(table.elevation[row]);
    const double lateral = ray.lateral * 0x1p-16;
    for (std::uint32_t column = 0; column < image.columns; ++column) {
      const double azimuth = rays.azimuth_of(row, column) * kTurn * 0x1p-32;
      const double length =
          cast({-lateral * std::sin(azimuth), lateral * std::cos(azimuth), ray.height * 0x1p-16},
               direction_of(elevation, azimuth));
      const bool there = random.uniform() < occupancy;
      image.range.push_back(
          there ? static_cast<std::int32_t>(std::llround(length * 0x1p16)) - ray.range_phase : 0);
    }
  }
  return image;
}

RayScan room(const RoomOptions& options = {}) {
  RayScan scan;
  scan.table = ray_rows(fit_of(options), 0);
  const compact::Image image = image_of_room(scan.table, options.occupancy);
  compact::ScanSettings settings;
  settings.steps = compact::steps_for_error(std::llround(options.error_m * 0x1p16));
  settings.effort = 1;
  const compact::EncodedScan encoded = compact::encode_scan(image, scan.table, settings).value();
  compact::ScanChunks chunks;
  for (const compact::ScanChunk& chunk : encoded.chunks) {
    chunks.chunks.push_back({chunk.part, chunk.payload, 0});
  }
  scan.decoded = compact::decode_scan(chunks).value();
  const compact::PointTable places(scan.table, image.rows, image.columns);
  for (std::uint32_t row = 0; row < image.rows; ++row) {
    for (std::uint32_t column = 0; column < image.columns; ++column) {
      const std::int32_t range = scan.decoded.range[std::size_t{row} * image.columns + column];
      if (range > 0) scan.points.push_back(places.metres(row, column, range));
    }
  }
  return scan;
}

/// As decode() gives it, with the number of each coded return.
DecodedScan public_scan(const RayScan& scan) {
  DecodedScan out;
  out.field = std::make_shared<CompactField>(scan.decoded);
  out.points = scan.points;
  out.coded_returns = scan.points.size();
  std::vector<std::uint32_t> numbers(scan.points.size());
  for (std::uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
  out.attributes = {{"number", 1, numbers}};
  return out;
}

double range_at(const Field& field, double row, double column, bool masked = true) {
  std::array<double, 1> range{};
  field.evaluate_row(row, std::array{column}, masked, range);
  return range[0];
}

Vec3 point_at(const Field& field, double row, double column) {
  const std::array range{range_at(field, row, column)};
  std::array<Vec3, 1> point;
  field.place_row(row, std::array{column}, range, point);
  return point[0];
}

double percentile_of(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

std::vector<double> distances_from_room(const Cloud& cloud) {
  std::vector<double> distances;
  for (const Vec3& p : cloud.positions) distances.push_back(away_from_room(p));
  return distances;
}

TEST(CompactFieldOnRays, GivesTheCodedPointWhereEachIsSeen) {
  for (const double error_m : {.05, .005}) {  // without and with residuals
    const RayScan scan = room({.error_m = error_m});
    const CompactField field(scan.decoded);
    std::size_t number = 0;
    for (std::uint32_t row = 0; row < field.lattice().rows(); ++row) {
      for (std::uint32_t column = 0; column < field.lattice().columns(); ++column) {
        if (!field.occupied(row, column)) continue;
        const Vec3& coded = scan.points[number++];
        const double seen = field.lattice().column_of(azimuth_of(coded));
        ASSERT_LT(norm(point_at(field, row, seen) - coded), .003) << row << " " << column;
        ASSERT_EQ(field.nearest_cell(row, seen),
                  std::size_t{row} * field.lattice().columns() + column);
      }
    }
    EXPECT_EQ(number, scan.points.size());
  }
}

TEST(CompactFieldOnRays, DenseRowsLieOnTheSurfaces) {
  const RayScan scan = room();
  const Cloud dense = reconstruct(public_scan(scan), {.rows = 4}).value();
  EXPECT_GT(dense.size(), 35 * scan.points.size() / 10);
  const std::vector<double> distances = distances_from_room(dense);
  EXPECT_LT(percentile_of(distances, .5), .01);
  EXPECT_LT(percentile_of(distances, .95), .04);
}

TEST(CompactFieldOnRays, DensePointsTakeTheAttributesOfTheirNeighbours) {
  const RayScan scan = room({.occupancy = .7});
  const Cloud dense = reconstruct(public_scan(scan), {.rows = 3, .columns = 1.5}).value();
  const auto& numbers = std::get<std::vector<std::uint32_t>>(dense.attributes[0].values);
  const double width = kTurn / scan.table.turn_columns;
  for (std::size_t i = 0; i < dense.size(); ++i) {
    const Vec3 &p = dense.positions[i], &neighbour = scan.points[numbers[i]];
    ASSERT_LT(std::abs(std::remainder(azimuth_of(p) - azimuth_of(neighbour), kTurn)), 4 * width);
    ASSERT_LT(std::abs(elevation_of(p) - elevation_of(neighbour)), .06);
  }
}

TEST(CompactFieldOnRays, DensePointsOfAMovedScanLieOnMovedSurfaces) {
  RoomOptions options;
  options.motion.turn = {.004, -.006, .05};
  options.motion.move = {1.2, -.3, .05};
  options.motion.rigid_turn = {.01, .02, -.03};
  options.motion.rigid_move = {.1, .2, -1.5};
  const RayScan scan = room(options);
  const Cloud dense = reconstruct(public_scan(scan), {.rows = 4}).value();
  std::vector<double> moved, distances;
  for (const Vec3& p : dense.positions) {
    moved.push_back(away_from_room(p));
    double least = 1e9;
    for (const double turns : {-1., 0., 1.}) {
      const Unmoved back = undo_motion(options.motion, p, turns);
      if (std::abs(back.s) <= .5) least = std::min(least, away_from_room(back.point));
    }
    distances.push_back(least);
  }
  EXPECT_GT(percentile_of(moved, .5), .05);
  EXPECT_LT(percentile_of(distances, .5), .01);
  EXPECT_LT(percentile_of(distances, .95), .04);
}

TEST(CompactFieldOnRays, BelievesNothingWhereNoRayLooked) {
  // Firing 900 looks 9 degrees to the right of straight ahead.
  const RayScan scan = room({.occupancy = 1, .gap_begin = 1800, .gap_end = 2100});
  const CompactField field(scan.decoded);
  const compact::RayTable& rays = *scan.table.rays;
  const std::uint32_t row = 5;
  const auto offset = static_cast<std::uint32_t>(rays.rays[row].azimuth_offset);
  const auto column_of = [&](std::uint32_t position) {
    return field.lattice().column_of((rays.encoder_angle(position) + offset) * kTurn * 0x1p-32);
  };
  EXPECT_TRUE(std::isnan(range_at(field, row, column_of(1950))));
  EXPECT_FALSE(std::isnan(range_at(field, row, column_of(1950), false)));
  EXPECT_FALSE(std::isnan(range_at(field, row, column_of(1700))));
  EXPECT_FALSE(std::isnan(range_at(field, row, column_of(2200))));
  // The width of what is not believed: that of the gap.
  std::size_t unseen = 0;
  for (std::uint32_t position = 1700; position < 2200; ++position) {
    unseen += std::isnan(range_at(field, row, column_of(position))) ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(unseen), 300, 5);
}

TEST(CompactFieldOnRays, WrapsAroundTheTurn) {
  const RayScan scan = room({.occupancy = 1});
  const CompactField field(scan.decoded);
  const double columns = field.lattice().columns();
  for (const double column : {-.75, -.25, .25, .75}) {
    EXPECT_NEAR(range_at(field, 6.4, column), range_at(field, 6.4, column + columns), 1e-6);
    EXPECT_LT(away_from_room(point_at(field, 6.4, column)), .05);
  }
}

/// A profile whose rays the scan has, through encode() and decode().
struct CodedRoom {
  SensorProfile sensor;
  DecodedScan scan;
  std::vector<std::byte> bytes;
};

CodedRoom coded_room() {
  CodedRoom out;
  const BeamModel model = test::two_blocks();
  out.sensor.name = "two-blocks";
  out.sensor.slots = model.slots;
  out.sensor.range_unit_m = model.range_unit_m;
  out.sensor.columns = model.slots / 2;
  for (const Beam& beam : model.beams) {
    out.sensor.rings.push_back(
        {beam.elevation, beam.azimuth_offset, beam.height_m, beam.lateral_m, beam.range_phase_m});
  }
  out.sensor.fov_up = model.beams.front().elevation;
  out.sensor.fov_down = model.beams.back().elevation;
  const RayScan scan = room({.error_m = .0005});
  Cloud cloud;
  cloud.positions = scan.points;
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  EncodeSettings settings;
  settings.sensor = out.sensor;
  settings.compact.effort = 1;
  settings.compact.target_value = .01;
  out.bytes = encode(cloud, settings).value().bytes;
  out.scan = decode(out.bytes).value();
  return out;
}

TEST(CompactFieldOnRays, FilesTellTheirBeamsAndRegionsHoldWhatLiesInThem) {
  const CodedRoom coded = coded_room();
  ASSERT_TRUE(coded.scan.records);
  ASSERT_EQ(coded.scan.records->lattice, RecordLattice::rays);
  ASSERT_EQ(coded.scan.sensor.rings.size(), coded.sensor.rings.size());
  EXPECT_EQ(coded.scan.sensor.slots, coded.sensor.slots);
  for (std::size_t k = 0; k < coded.sensor.rings.size(); ++k) {
    const Ring &told = coded.scan.sensor.rings[k], &ring = coded.sensor.rings[k];
    EXPECT_NEAR(told.azimuth_offset, ring.azimuth_offset, 1e-4);
    EXPECT_NEAR(told.vertical_offset_m, ring.vertical_offset_m, .001);
    EXPECT_NEAR(told.horizontal_offset_m, ring.horizontal_offset_m, .001);
    EXPECT_NEAR(told.range_phase_m, ring.range_phase_m, .001);
  }
  DecodeOptions options;
  options.region = ScanRegion{0, 100, -.3, .4};
  const DecodedScan part = decode(coded.bytes, options).value();
  std::size_t inside = 0;
  const std::size_t in_cells = coded.scan.points.size() - coded.scan.records->loose;
  for (std::size_t i = 0; i < in_cells; ++i) {
    const double azimuth = azimuth_of(coded.scan.points[i]);
    inside += azimuth >= -.3 && azimuth < .4 ? 1 : 0;
  }
  EXPECT_EQ(part.points.size(), inside);
  EXPECT_GT(inside, in_cells / 12);
  for (const Vec3& p : part.points) {
    ASSERT_GE(azimuth_of(p), -.3);
    ASSERT_LT(azimuth_of(p), .4);
  }
  const Cloud dense = reconstruct(part, {.rows = 4}).value();
  EXPECT_GT(dense.size(), 3 * inside);
}

TEST(CompactFieldOnRays, DenseRowsOfARealScanLieAmongItsReturns) {
  const auto data = test::data_directory();
  const auto path = data.value_or("") / "kitti_raw/sfnd/data_1/0000000000.pcd";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no kitti_raw/sfnd in the data";
  const Cloud cloud = read_cloud(path.string()).value();
  EncodeSettings settings;
  settings.compact.effort = 1;
  settings.compact.target_value = .05;
  const DecodedScan scan = decode(encode(cloud, settings).value().bytes).value();
  ASSERT_EQ(scan.records->lattice, RecordLattice::rays);
  const Cloud dense = reconstruct(scan, {.rows = 2}).value();
  EXPECT_GT(dense.size(), 18 * cloud.size() / 10);
  const Comparison found = compare(cloud, dense).value();
  EXPECT_LT(found.a_to_b.p50, .035);
  EXPECT_LT(found.b_to_a.p50, .05);
}

}  // namespace
}  // namespace curlidar
