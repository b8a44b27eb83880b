// SPDX-License-Identifier: BSD-3-Clause
// Files of the compact profile: targets, exactness, decoding in part.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "curlidar/reconstruct.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/io.hpp"
#include "support/data.hpp"
#include "support/scans.hpp"

namespace curlidar {
namespace {

using test::small_scan;
using test::small_sensor;

/// What `curlidar project --rows rings` makes of a scan, in float32 as files hold it.
Cloud cell_centres(const Cloud& scan, std::uint32_t columns = 256) {
  ProjectSettings settings;
  settings.row_rule = RowRule::rings;
  settings.columns = columns;
  Cloud grid = project(scan, assign_rings(scan, small_sensor()).value(), settings).value();
  grid.metadata.clear();
  for (Vec3& p : grid.positions) {
    p = {static_cast<double>(static_cast<float>(p.x)), static_cast<double>(static_cast<float>(p.y)),
         static_cast<double>(static_cast<float>(p.z))};
  }
  return grid;
}

EncodeSettings settings_for(CompactTarget target, double value, std::uint32_t effort = 2) {
  EncodeSettings settings;
  settings.compact.target = target;
  settings.compact.target_value = value;
  settings.compact.effort = effort;
  settings.attributes.emplace();
  return settings;
}

double mean_distance(const Cloud& a, const Cloud& b) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!is_return(a.positions[i])) continue;
    sum += norm(a.positions[i] - b.positions[i]);
    ++count;
  }
  return sum / static_cast<double>(count);
}

TEST(Compact, IsTheDefault) {
  EXPECT_EQ(EncodeSettings{}.profile, Profile::compact);
  const Encoded encoded = encode(small_scan(), settings_for(CompactTarget::step, 0.3)).value();
  const DecodedScan scan = decode(encoded.bytes).value();
  EXPECT_EQ(scan.profile, Profile::compact);
  EXPECT_TRUE(scan.compact);
  EXPECT_FALSE(scan.paper);
  EXPECT_TRUE(scan.missing.empty());
}

TEST(Compact, CellCentresKeepExactlyTheirCells) {
  const Cloud grid = cell_centres(small_scan());
  for (const double error : {0.05, 0.01, 0.001}) {
    const Encoded encoded = encode(grid, settings_for(CompactTarget::error, error)).value();
    EXPECT_TRUE(encoded.report.compact->cell_centres);
    EXPECT_EQ(encoded.report.points_coded, count_returns(grid));
    const Cloud back = reconstruct(decode(encoded.bytes).value(), {.organised = true}).value();
    ASSERT_EQ(back.size(), grid.size());
    ASSERT_EQ(back.width, grid.width);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      ASSERT_EQ(is_return(back.positions[i]), is_return(grid.positions[i])) << "cell " << i;
    }
    const double mean = mean_distance(grid, back);
    EXPECT_LE(mean, error);
    EXPECT_GT(mean, 0.95 * error);
    EXPECT_NEAR(mean, encoded.report.compact->mean_error_m, 1e-12);
  }
}

TEST(Compact, RowsWithoutAReturnStay) {
  Cloud grid = cell_centres(small_scan());
  const auto clear = [&](std::size_t row) {
    std::fill_n(grid.positions.begin() + static_cast<std::ptrdiff_t>(row * grid.width), grid.width,
                Vec3{});
  };
  for (const std::size_t row : {0u, 1u, 9u, 23u}) clear(row);
  const Encoded encoded = encode(grid, settings_for(CompactTarget::step, 0.1)).value();
  const DecodedScan scan = decode(encoded.bytes).value();
  EXPECT_EQ(scan.field->lattice().rows(), grid.height);
  EXPECT_EQ(scan.coded_returns, count_returns(grid));
  EXPECT_TRUE(validate(scan.sensor)) << validate(scan.sensor).error().message;
}

TEST(Compact, BreakdownIsTheFile) {
  const Encoded encoded =
      encode(cell_centres(small_scan()), settings_for(CompactTarget::error, 0.01)).value();
  const CompactReport& report = *encoded.report.compact;
  EXPECT_NEAR(report.breakdown.total(), 8.0 * static_cast<double>(encoded.bytes.size()), 1e-3);
  EXPECT_NEAR(report.bits_per_point_coded,
              report.breakdown.total() / static_cast<double>(encoded.report.points_coded), 1e-9);
  EXPECT_GT(report.breakdown.residual, 0);
  EXPECT_GT(report.statistics.leaves, 0u);
}

TEST(Compact, TargetsAreReachedAndNotExceeded) {
  const Cloud grid = cell_centres(small_scan());
  const Encoded near = encode(grid, settings_for(CompactTarget::error_nn, 0.03)).value();
  const Cloud back = reconstruct(decode(near.bytes).value()).value();
  const Comparison distances = compare(back, grid).value();
  const double worse = std::max(distances.a_to_b.mean, distances.b_to_a.mean);
  EXPECT_LE(worse, 0.03);
  EXPECT_GT(worse, 0.95 * 0.03);
  EXPECT_NEAR(worse, near.report.compact->error_nn_m.value(), 1e-7);  // float32

  for (const double bits : {1.5, 4.0, 9.0}) {
    const Encoded encoded = encode(grid, settings_for(CompactTarget::bits_per_point, bits)).value();
    const double reached = 8.0 * static_cast<double>(encoded.bytes.size()) /
                           static_cast<double>(encoded.report.points_coded);
    EXPECT_LE(reached, bits);
    EXPECT_GE(reached, 0.97 * bits);
  }
  const Encoded step = encode(grid, settings_for(CompactTarget::step, 0.25)).value();
  EXPECT_EQ(step.report.compact->step_m, 0.25);
  EXPECT_EQ(step.report.compact->encodings, 1u);
}

TEST(Compact, TargetsOutOfReachSayWhatHelps) {
  const Cloud scan = small_scan();
  EncodeSettings settings = settings_for(CompactTarget::error, 0.002);
  settings.sensor = small_sensor();
  settings.compact.columns = 200;  // the sensor fires 256 times: most returns lie beside a middle
  const Result<Encoded> exact = encode(scan, settings);
  ASSERT_FALSE(exact);
  EXPECT_EQ(exact.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(exact.error().message.find("--cols"), std::string::npos) << exact.error().message;
  const Result<Encoded> small = encode(scan, settings_for(CompactTarget::bits_per_point, 0.001));
  ASSERT_FALSE(small);
  EXPECT_NE(small.error().message.find("out of reach"), std::string::npos);
}

TEST(Compact, SettingsThatMakeNoSenseAreRefused) {
  const Cloud scan = small_scan();
  for (const double value : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    EXPECT_EQ(encode(scan, settings_for(CompactTarget::error, value)).error().code,
              ErrorCode::invalid_argument);
  }
  EXPECT_FALSE(encode(scan, settings_for(CompactTarget::error, 0.05, 0)));
  EXPECT_FALSE(encode(scan, settings_for(CompactTarget::error, 0.05, 10)));
  EncodeSettings columns = settings_for(CompactTarget::error, 0.05);
  columns.compact.columns = 3;
  EXPECT_FALSE(encode(scan, columns));
}

TEST(Compact, EveryReturnIsAccountedFor) {
  EncodeSettings settings = settings_for(CompactTarget::step, 0.3);
  settings.sensor = small_sensor();
  settings.compact.columns = 200;
  settings.compact.min_range_m = 5;
  settings.compact.max_range.metres = 40;
  const EncodeReport report = encode(small_scan(), settings)->report;
  const ProjectionCounts& c = report.projection;
  EXPECT_GT(c.out_of_range, 0u);
  EXPECT_GT(c.collided, 0u);
  EXPECT_EQ(c.kept + c.out_of_range + c.out_of_fov + c.collided, report.points_in);
  EXPECT_EQ(report.points_coded, c.kept);
}

TEST(Compact, AttributesAndMetadataComeBack) {
  Cloud scan = small_scan();
  scan.metadata["frame_id"] = "lidar";
  EncodeSettings settings = settings_for(CompactTarget::error, 0.02);
  settings.sensor = small_sensor();
  settings.attributes.reset();
  settings.compact.columns = 256;
  const Encoded encoded = encode(scan, settings).value();
  const DecodedScan decoded = decode(encoded.bytes).value();
  EXPECT_EQ(decoded.metadata.at("frame_id"), "lidar");
  EXPECT_EQ(decoded.sensor.name, "small");
  const Cloud back = reconstruct(decoded).value();
  ASSERT_EQ(back.attributes.size(), scan.attributes.size());
  // Each decoded return carries the attributes of an original near it.
  const Attribute* ring = back.find("ring");
  ASSERT_NE(ring, nullptr);
  std::size_t same = 0;
  for (std::size_t i = 0; i < back.size(); ++i) {
    const double row = std::round((10 - elevation_of(back.positions[i]) / test::kDegree) / 30 * 23);
    same += std::abs(ring->as_double(i) - row) < 0.5 ? 1 : 0;
  }
  EXPECT_GT(same, back.size() * 9 / 10);
}

TEST(Compact, SameBytesForAnyNumberOfThreads) {
  const Cloud grid = cell_centres(small_scan());
  EncodeSettings settings = settings_for(CompactTarget::error, 0.02);
  const auto one = encode(grid, settings)->bytes;
  for (const std::size_t threads : {2u, 5u}) {
    settings.threads = threads;
    EXPECT_EQ(encode(grid, settings)->bytes, one) << threads << " threads";
    DecodeOptions options;
    options.threads = threads;
    EXPECT_EQ(decode(one, options)->points, decode(one)->points);
  }
}

/// A file with several segments and residuals, with attributes or without.
Encoded partial_file(bool attributes) {
  SensorProfile sensor = small_sensor(24, 1024);
  Cloud scan = small_scan("street", sensor);
  EncodeSettings settings = settings_for(CompactTarget::error, 0.01, 1);
  settings.sensor = sensor;
  settings.compact.columns = 1024;
  settings.compact.target = CompactTarget::error;
  if (attributes) settings.attributes.reset();
  return encode(scan, settings).value();
}

TEST(Compact, RegionsAreTheSameReturns) {
  for (const bool attributes : {false, true}) {
    const auto bytes = partial_file(attributes).bytes;
    const DecodedScan whole = decode(bytes).value();
    const double degree = std::numbers::pi / 180;
    DecodeOptions options;
    // Across the seam behind the sensor.
    options.region = ScanRegion{6, 18, 150 * degree, 210 * degree};
    const DecodedScan part = decode(bytes, options).value();
    std::vector<Vec3> expected;
    std::vector<std::uint32_t> kept;
    const Field& field = *whole.field;
    std::uint32_t number = 0;
    for (std::uint32_t row = 0; row < 24; ++row) {
      for (std::uint32_t column = 0; column < 1024; ++column) {
        if (!field.occupied(row, column)) continue;
        double azimuth = field.lattice().azimuth(column) / degree;
        if (azimuth < 0) azimuth += 360;
        if (row >= 6 && row < 18 && azimuth >= 150 && azimuth < 210) kept.push_back(number);
        ++number;
      }
    }
    for (const std::uint32_t i : kept) expected.push_back(whole.points[i]);
    EXPECT_EQ(part.points, expected);
    EXPECT_EQ(part.coded_returns, expected.size());
    EXPECT_GT(expected.size(), 100u);
    ASSERT_EQ(part.attributes.size(), whole.attributes.size());
    for (std::size_t a = 0; a < part.attributes.size(); ++a) {
      for (std::size_t i = 0; i < kept.size(); ++i) {
        ASSERT_EQ(part.attributes[a].as_double(i), whole.attributes[a].as_double(kept[i]));
      }
    }
  }
}

TEST(Compact, RegionsThatHoldNothingAreRefused) {
  const auto bytes = partial_file(false).bytes;
  for (const ScanRegion& region : {ScanRegion{30, 40}, ScanRegion{5, 5}, ScanRegion{0, 9, 1, 1},
                                   ScanRegion{0, 9, 0.0001, 0.0002}}) {
    DecodeOptions options;
    options.region = region;
    EXPECT_EQ(decode(bytes, options).error().code, ErrorCode::invalid_argument);
  }
}

TEST(Compact, TheFieldAloneIsCoarser) {
  const Encoded encoded = partial_file(false);
  DecodeOptions options;
  options.field_only = true;
  const DecodedScan whole = decode(encoded.bytes).value();
  const DecodedScan coarse = decode(encoded.bytes, options).value();
  ASSERT_EQ(coarse.points.size(), whole.points.size());
  double gap = 0;
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    gap += norm(whole.points[i] - coarse.points[i]) / static_cast<double>(whole.points.size());
  }
  EXPECT_GT(gap, 0.003);
  EXPECT_LT(gap, 1);
  EXPECT_TRUE(coarse.missing.empty());
}

TEST(Compact, CutFilesDecodeAsFarAsTheyGo) {
  const auto bytes = partial_file(true).bytes;
  const DecodedScan whole = decode(bytes).value();
  DecodeOptions options;
  options.allow_truncated = true;
  std::size_t last = 0;
  for (const double share : {0.1, 0.3, 0.6, 0.9, 0.99}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(bytes.size()));
    const auto cut = std::span(bytes).first(size);
    EXPECT_FALSE(decode(cut));
    const Result<DecodedScan> part = decode(cut, options);
    ASSERT_TRUE(part) << part.error().message;
    EXPECT_FALSE(part->missing.empty());
    EXPECT_GE(part->points.size(), last) << "at " << size;
    EXPECT_LE(part->points.size(), whole.points.size());
    EXPECT_TRUE(part->attributes.empty());
    last = part->points.size();
  }
  EXPECT_EQ(last, whole.points.size());
  EXPECT_TRUE(decode(bytes, options)->missing.empty());
}

TEST(Compact, PaperFilesAreNotDecodedInPart) {
  const auto bytes = encode(small_scan(), test::small_settings())->bytes;
  DecodeOptions options;
  options.field_only = true;
  EXPECT_EQ(decode(bytes, options).error().code, ErrorCode::invalid_argument);
}

TEST(Compact, PartitionCoversEveryReturnOnce) {
  const auto bytes = partial_file(false).bytes;
  DecodeOptions options;
  options.partition = true;
  const DecodedScan scan = decode(bytes, options).value();
  const CompactContents& contents = *scan.compact;
  const Lattice& lattice = scan.field->lattice();
  ASSERT_EQ(contents.layer.size(), lattice.cells());
  std::vector<std::uint32_t> layers(lattice.cells(), 0);
  for (const CompactLeaf& leaf : contents.leaves) {
    for (std::uint32_t i = 0; i < leaf.rows; ++i) {
      for (std::uint32_t j = 0; j < leaf.columns; ++j) {
        std::uint32_t& cell =
            layers[std::size_t{leaf.row + i} * lattice.columns() + leaf.column + j];
        EXPECT_EQ(cell, 0u);
        cell = leaf.layers;
      }
    }
  }
  for (std::uint32_t row = 0; row < lattice.rows(); ++row) {
    for (std::uint32_t column = 0; column < lattice.columns(); ++column) {
      const std::size_t cell = std::size_t{row} * lattice.columns() + column;
      if (scan.field->occupied(row, column)) {
        ASSERT_LT(contents.layer[cell], layers[cell]);
      } else {
        ASSERT_EQ(contents.layer[cell], 255);
      }
    }
  }
  EXPECT_EQ(contents.statistics.leaves, contents.leaves.size());
  EXPECT_TRUE(decode(bytes)->compact->leaves.empty());
}

TEST(Compact, KittiScanAtFiveCentimetres) {
  const auto data = test::data_directory();
  if (!data) GTEST_SKIP() << "set CURLIDAR_DATA to the folder with the real scans";
  const Cloud scan = read_cloud((*data / "kitti_odometry_00/velodyne/000003.bin").string()).value();
  EncodeSettings settings = settings_for(CompactTarget::error, 0.05, 2);
  settings.threads = 0;
  settings.compact.coverage = Coverage::image;
  const EncodeReport report = encode(scan, settings)->report;
  EXPECT_TRUE(report.compact->heights);  // beams do not leave from the origin
  EXPECT_TRUE(report.compact->range_offsets);
  EXPECT_GT(report.points_coded, report.points_in * 9 / 10);
  EXPECT_LE(report.compact->mean_error_m, 0.05);
  EXPECT_LT(report.compact->bits_per_point_coded, 1.5);
}

}  // namespace
}  // namespace curlidar
