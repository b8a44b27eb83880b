// SPDX-License-Identifier: BSD-3-Clause
// Maps of scans: their parts, and files of them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <random>

#include "curlidar/io.hpp"
#include "curlidar/map.hpp"
#include "format/indexed_file.hpp"
#include "mapfile/map_header.hpp"
#include "support/scans.hpp"

namespace curlidar {
namespace {

/// A rotation by `angle` about any axis, and a move.
RigidMotion pose_of(Vec3 axis, double angle, const Vec3& move) {
  axis = axis * (1 / norm(axis));
  const double c = std::cos(angle), s = std::sin(angle);
  RigidMotion pose;
  const Vec3 units[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  // Rodrigues' formula: columns are what the units become, so rows are those of the inverse.
  for (std::size_t k = 0; k < 3; ++k) {
    pose.rotation[k] =
        units[k] * c + cross(units[k], axis) * s + axis * (dot(axis, units[k]) * (1 - c));
  }
  pose.move = move;
  return pose;
}

double largest_difference(const RigidMotion& a, const RigidMotion& b) {
  double most = 0;
  for (std::size_t k = 0; k < 3; ++k) most = std::max(most, norm(a.rotation[k] - b.rotation[k]));
  return most;
}

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto* data = reinterpret_cast<const std::byte*>(text.data());
  return {data, data + text.size()};
}

TEST(ScanPart, PosesComeBackWithinABillionth) {
  std::mt19937_64 random(7);
  const auto number = [&] { return static_cast<double>(random() % 20001) / 10000.0 - 1; };
  for (int i = 0; i < 500; ++i) {
    const Vec3 move{number() * 1e7, number() * 1e7, number() * 1e3};
    const double angle = i < 8 ? i * std::numbers::pi / 4 : 4 * number();
    const RigidMotion pose = pose_of({number(), number(), number() + 1.5}, angle, move);
    const MapScan back =
        read_scan_part(write_scan_part(pose, 1.5 * i, bytes_of("scan")), "x").value();
    EXPECT_EQ(back.T_map_sensor.move, move);
    EXPECT_LT(largest_difference(back.T_map_sensor, pose), 5e-9) << i;
    EXPECT_EQ(back.T_map_sensor, coded_pose(pose));
    EXPECT_EQ(back.time_s, 1.5 * i);
    EXPECT_EQ(back.file, bytes_of("scan"));
  }
}

TEST(ScanPart, ATimeMayBeMissing) {
  const MapScan back = read_scan_part(write_scan_part({}, {}, {}), "x").value();
  EXPECT_FALSE(back.time_s);
  EXPECT_TRUE(back.file.empty());
  EXPECT_EQ(back.T_map_sensor, RigidMotion{});
}

TEST(ScanPart, WhatIsNoPoseIsRefused) {
  const std::vector<std::byte> part = write_scan_part({}, 1.0, bytes_of("scan"));
  for (std::size_t size = 0; size < 3 * 8 + 4 * 4 + 8; ++size) {
    const auto cut = read_scan_part(ByteSpan(part).first(size), "x");
    ASSERT_FALSE(cut) << size;
    EXPECT_EQ(cut.error().code, ErrorCode::corrupt);
  }
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity(), 2e12}) {
    RigidMotion pose;
    pose.move.y = wrong;
    EXPECT_FALSE(read_scan_part(write_scan_part(pose, {}, {}), "x"));
  }
  // Quaternions that are not of length 1.
  for (const unsigned top : {0x41u, 0x3fu, 0x00u, 0x7fu}) {
    std::vector<std::byte> longer = part;
    longer[24 + 3] = static_cast<std::byte>(top);
    EXPECT_FALSE(read_scan_part(longer, "x")) << top;
  }
}

class ScanMap : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("curlidar-scan-map-") +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }

  static MapBuildSettings settings() {
    MapBuildSettings settings;
    settings.header.kind = MapKind::scans;
    settings.header.min_range_m = 1;
    settings.header.metadata = {{"place", "street"}};
    settings.scan.sensor = test::small_sensor(16, 128);
    settings.scan.attributes = std::vector<std::string>{};
    settings.scan.compact.coverage = Coverage::image;
    settings.scan.compact.columns = 128;
    settings.scan.compact.target = CompactTarget::step;
    settings.scan.compact.target_value = 0.1;
    settings.scan.compact.effort = 1;
    return settings;
  }
  static RigidMotion pose(std::size_t scan) {
    return pose_of({0, 0.1, 1}, 0.2 * static_cast<double>(scan),
                   {1000.5 + 2.0 * static_cast<double>(scan), 0, 3});
  }
  static const Cloud& cloud() {
    static const Cloud scan = test::small_scan("street", test::small_sensor(16, 128));
    return scan;
  }

  /// Offers scans [begin, end).
  static void offer(MapBuilder& builder, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto added = builder.add_scan(cloud(), pose(i), 0.1 * static_cast<double>(i));
      ASSERT_TRUE(added) << added.error().message;
    }
  }

  std::filesystem::path folder_;
};

TEST_F(ScanMap, KeepsEveryThirdScanWhole) {
  MapBuildSettings every = settings();
  every.every_scans = 3;
  MapBuilder builder = MapBuilder::create(every).value();
  offer(builder, 0, 8);
  const MapReport report = builder.finish(path("map.curl")).value();
  EXPECT_EQ(report.taken, 3u);
  EXPECT_EQ(report.offered, 8u);

  const MapFile map = MapFile::open(path("map.curl")).value();
  EXPECT_EQ(map.header().kind, MapKind::scans);
  EXPECT_EQ(map.header().scans, 3u);
  EXPECT_NEAR(map.header().travelled_m, 14, 1e-9);
  EXPECT_EQ(map.header().metadata.at("place"), "street");
  EXPECT_EQ(map.file_bytes(), report.bytes);
  EXPECT_TRUE(map.tiles().empty());
  ASSERT_EQ(map.scans().size(), 3u);
  // Each part holds what encode gives for its scan, and the box holds its points.
  EncodeSettings alone = every.scan;
  alone.compact.min_range_m = 1;
  alone.compact.max_range = {map.header().max_range_m, 0};
  const Encoded encoded = encode(cloud(), alone).value();
  for (std::size_t k = 0; k < 3; ++k) {
    const MapScan scan = map.read_scan(k).value();
    EXPECT_EQ(scan.file, encoded.bytes);
    EXPECT_EQ(scan.T_map_sensor, coded_pose(pose(3 * k)));
    EXPECT_DOUBLE_EQ(*scan.time_s, 0.3 * static_cast<double>(k));
    const DecodedScan decoded = decode(scan.file).value();
    const MapBox& box = map.scans()[k].box;
    EXPECT_EQ(map.scans()[k].points, decoded.points.size());
    for (const Vec3& p : decoded.points) {
      const Vec3 q = scan.T_map_sensor(p);
      ASSERT_TRUE(q.x >= box.low.x && q.x <= box.high.x && q.y >= box.low.y && q.y <= box.high.y &&
                  q.z >= box.low.z && q.z <= box.high.z);
    }
  }
  EXPECT_FALSE(map.read_scan(3));
  EXPECT_FALSE(map.read_tile(0));
}

TEST_F(ScanMap, TakesOneEveryFewMetres) {
  MapBuildSettings every = settings();
  every.every_m = 3.5;
  MapBuilder builder = MapBuilder::create(every).value();
  offer(builder, 0, 7);
  ASSERT_TRUE(builder.finish(path("map.curl")));
  const MapFile map = MapFile::open(path("map.curl")).value();
  ASSERT_EQ(map.scans().size(), 4u);  // 0, 4, 8 and 12 m
  EXPECT_EQ(map.read_scan(1)->T_map_sensor, coded_pose(pose(2)));
}

TEST_F(ScanMap, AppendingKeepsTheOldPartsByteByByte) {
  MapBuilder builder = MapBuilder::create(settings()).value();
  offer(builder, 0, 2);
  ASSERT_TRUE(builder.finish(path("map.curl")));
  const auto old = std::make_shared<const MapFile>(MapFile::open(path("map.curl")).value());
  MapBuilder more = MapBuilder::append(old, settings()).value();
  offer(more, 2, 4);
  ASSERT_TRUE(more.finish(path("longer.curl")));
  const MapFile longer = MapFile::open(path("longer.curl")).value();
  ASSERT_EQ(longer.scans().size(), 4u);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(*longer.read_part(k), *old->read_part(k));
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(longer.read_scan(k)->T_map_sensor, coded_pose(pose(k)));
  }
}

TEST_F(ScanMap, DamageStaysInItsPart) {
  MapBuilder builder = MapBuilder::create(settings()).value();
  offer(builder, 0, 3);
  ASSERT_TRUE(builder.finish(path("map.curl")));
  std::vector<std::byte> bytes = read_file(path("map.curl")).value();
  const MapFile whole = MapFile::read(bytes, "map").value();
  const std::vector<std::byte> second = whole.read_part(1).value();
  const auto at = std::search(bytes.begin(), bytes.end(), second.begin(), second.end());
  ASSERT_NE(at, bytes.end());
  at[60] ^= std::byte{1};
  const MapFile damaged = MapFile::read(bytes, "map").value();
  EXPECT_TRUE(damaged.read_scan(0));
  EXPECT_TRUE(damaged.read_scan(2));
  const auto scan = damaged.read_scan(1);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().code, ErrorCode::corrupt);
}

TEST_F(ScanMap, CutOffAnywhereItIsRefusedOrTellsWhatIsMissing) {
  MapBuilder builder = MapBuilder::create(settings()).value();
  offer(builder, 0, 3);
  ASSERT_TRUE(builder.finish(path("map.curl")));
  const std::vector<std::byte> bytes = read_file(path("map.curl")).value();
  MapReadOptions cut;
  cut.allow_truncated = true;
  std::size_t most = 0;
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 40) {
    std::vector<std::byte> part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(MapFile::read(part, "map")) << size;
    const auto map = MapFile::read(part, "map", cut);
    if (!map) continue;
    EXPECT_FALSE(map->missing().empty()) << size;
    EXPECT_GE(map->scans().size(), most);
    most = map->scans().size();
    for (std::size_t k = 0; k < most; ++k) {
      EXPECT_EQ(map->read_scan(k)->T_map_sensor, coded_pose(pose(k)));
    }
  }
  EXPECT_GE(most, 2u);
}

TEST_F(ScanMap, TheGoldenFileIsReadAndWrittenAsEver) {
  const std::string golden = std::string(CURLIDAR_TEST_FOLDER) + "/../../golden/";
  struct Keyframe {
    const char* file;
    Vec3 place;
    double cosine, sine;
    std::optional<double> time_s;
  };
  const Keyframe keyframes[] = {{"street-16", {1000.5, -2000.25, 3.125}, 0, 1, 1.5},
                                {"room-16-fast", {1010, -2001, 3}, 0.6, 0.8, {}}};
  MapHeader header;
  header.kind = MapKind::scans;
  header.origin = {1000, -2000, 3};
  header.scans = 2;
  header.travelled_m = 9.5;
  header.metadata = {{"place", "Stra\u00dfe"}};
  IndexedWriter writer =
      IndexedWriter::create(path("map.curl"), IndexedKind::scan_map, *write_map_header(header))
          .value();
  const MapFile map = MapFile::open(golden + "scan_maps/two-scans.curl").value();
  ASSERT_EQ(map.scans().size(), 2u);
  EXPECT_EQ(map.header().metadata, header.metadata);
  for (std::size_t k = 0; k < 2; ++k) {
    const Keyframe& frame = keyframes[k];
    RigidMotion pose;
    pose.rotation[0] = {frame.cosine, -frame.sine, 0};
    pose.rotation[1] = {frame.sine, frame.cosine, 0};
    pose.move = frame.place;
    const std::vector<std::byte> file =
        read_file(golden + "compact/" + frame.file + ".curl").value();
    const ScanExtent extent = extent_of(decode(file)->points);
    ASSERT_TRUE(writer.add(write_scan_part(pose, frame.time_s, file),
                           write_scan_summary(pose, header, extent.radius_m, extent.points)));
    const MapScan scan = map.read_scan(k).value();
    EXPECT_EQ(scan.file, file);
    EXPECT_EQ(scan.time_s, frame.time_s);
    EXPECT_EQ(scan.T_map_sensor.move, frame.place);
    EXPECT_LT(largest_difference(scan.T_map_sensor, pose), 5e-9);
    EXPECT_EQ(map.scans()[k].points, extent.points);
  }
  ASSERT_TRUE(writer.finish());
  EXPECT_EQ(*read_file(path("map.curl")), *read_file(golden + "scan_maps/two-scans.curl"));
}

}  // namespace
}  // namespace curlidar
