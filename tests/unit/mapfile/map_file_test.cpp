// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <string>

#include "curlidar/io.hpp"
#include "curlidar/map.hpp"
#include "curlidar/simulate.hpp"
#include "format/indexed_file.hpp"
#include "mapfile/map_header.hpp"

namespace curlidar {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

RigidMotion pose_at(const Vec3& place, double yaw = 0) {
  RigidMotion pose;
  pose.rotation = {
      {{std::cos(yaw), -std::sin(yaw), 0}, {std::sin(yaw), std::cos(yaw), 0}, {0, 0, 1}}};
  pose.move = place;
  return pose;
}

/// What a sensor 2 m above flat ground sees of it and of a wall at y = 6, both endless; `shift`
/// moves the grid of points, as another drive would.
Cloud street_from(const RigidMotion& pose, double shift = 0) {
  Cloud cloud;
  const double x0 = std::floor(pose.move.x) + shift, y0 = std::floor(pose.move.y - 1000);
  const double ground = pose.move.z - 2;
  for (int i = -75; i <= 75; ++i) {
    for (int j = -40; j <= 40; ++j) {
      cloud.positions.push_back(pose.undo({x0 + i * 0.15, y0 + 1000 + j * 0.15, ground}));
    }
    for (int k = 0; k < 20; ++k) {
      cloud.positions.push_back(pose.undo({x0 + i * 0.15, y0 + 1006.03, ground + k * 0.15}));
    }
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  return cloud;
}

class MapFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("curlidar-map-" + std::to_string(::getpid()) + "-" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static MapBuildSettings settings() {
    MapBuildSettings settings;
    settings.header.min_range_m = 1;
    settings.header.max_range_m = 30;
    settings.header.metadata = {{"place", "Maße"}};
    return settings;
  }

  /// A drive of `scans` scans, 5 m from each other along x.
  void offer(MapBuilder& builder, std::size_t scans, const Vec3& start, double shift = 0) const {
    for (std::size_t i = 0; i < scans; ++i) {
      const RigidMotion pose = pose_at(start + Vec3{5.0 * static_cast<double>(i), 0, 0}, 0.3);
      const auto added = builder.add_scan(street_from(pose, shift), pose);
      ASSERT_TRUE(added) << added.error().message;
    }
  }
  MapReport drive(const std::string& name, const MapBuildSettings& settings, std::size_t scans,
                  const Vec3& start) const {
    MapBuilder builder = MapBuilder::create(settings).value();
    offer(builder, scans, start);
    const auto report = builder.finish(path(name));
    EXPECT_TRUE(report) << report.error().message;
    return *report;
  }
  MapFile open(const std::string& name) const {
    auto map = MapFile::open(path(name));
    EXPECT_TRUE(map) << map.error().message;
    return *std::move(map);
  }

 private:
  fs::path folder_;
};

TEST_F(MapFileTest, HoldsTheSurfaceAndWhatIsToldOfIt) {
  const MapReport report = drive("a.curl", settings(), 6, {3.5, 1.5, 2});
  EXPECT_EQ(report.taken, 6u);
  const MapFile map = open("a.curl");
  EXPECT_EQ(map.header().kind, MapKind::surface);
  EXPECT_EQ(map.header().scans, 6u);
  EXPECT_NEAR(map.header().travelled_m, 25, 1e-9);
  EXPECT_EQ(map.header().origin, (Vec3{3, 1, 2}));
  EXPECT_EQ(map.header().metadata.at("place"), "Maße");
  EXPECT_EQ(map.file_bytes(), report.bytes);
  ASSERT_GE(map.tiles().size(), 4u);
  EXPECT_LE(static_cast<double>(map.index_bytes()),
            28 + 10 + 24.0 * static_cast<double>(map.tiles().size()));
  const auto cloud = extract_points(map);
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_GT(cloud->size(), 10000u);
  const MapBox extent = map.extent().value();
  for (const Vec3& p : cloud->positions) {
    EXPECT_LT(std::min(std::abs(p.z), std::abs(p.y - 7.03)), 0.06);
    EXPECT_GE(p.x, extent.low.x);
    EXPECT_LE(p.x, extent.high.x);
    EXPECT_GE(p.z, extent.low.z);
    EXPECT_LE(p.z, extent.high.z);
  }
}

TEST_F(MapFileTest, TilesMeetWithoutCracksOrDoubles) {
  drive("a.curl", settings(), 8, {3.5, 1.5, 2});
  const MapFile map = open("a.curl");
  ASSERT_GT(map.tiles().back().key.x, map.tiles().front().key.x);
  MapExtractSettings extract;
  extract.spacing_m = 0.125;
  extract.box = MapBox{{0, -1, -0.5}, {40, 3, 0.5}};  // ground across the borders at x = 3 and 35
  const Cloud cloud = extract_points(map, extract).value();
  std::map<std::pair<long, long>, int> cells;
  for (const Vec3& p : cloud.positions) {
    ++cells[{std::lround(std::floor(p.x * 4)), std::lround(std::floor(p.y * 4))}];
  }
  for (long x = 1; x < 159; ++x) {
    for (long y = -3; y < 11; ++y) {
      EXPECT_EQ((cells[{x, y}]), 4) << "cell " << x << " " << y;
    }
  }
}

TEST_F(MapFileTest, BytesDependNeitherOnThreadsNorOnMemory) {
  MapBuildSettings one = settings(), many = settings(), tight = settings();
  many.threads = 3;
  tight.max_samples = 5000;
  drive("one.curl", one, 8, {0, 0, 2});
  drive("many.curl", many, 8, {0, 0, 2});
  const MapReport report = drive("tight.curl", tight, 8, {0, 0, 2});
  EXPECT_EQ(read_file(path("one.curl")).value(), read_file(path("many.curl")).value());
  EXPECT_EQ(read_file(path("one.curl")).value(), read_file(path("tight.curl")).value());
  // A scan and the limit, not all of them.
  EXPECT_LT(report.most_samples, 20000u);
  EXPECT_GT(report.samples, 40000u);
}

TEST_F(MapFileTest, FarFromZeroIsAsGoodAsNear) {
  const Vec3 far{512345, 5412345, 300};
  drive("near.curl", settings(), 3, {0.5, 0.5, 2});
  drive("far.curl", settings(), 3, far + Vec3{0.5, 0.5, 2});
  const MapFile near_map = open("near.curl"), far_map = open("far.curl");
  EXPECT_EQ(far_map.header().origin, far + Vec3({0, 0, 2}));
  ASSERT_EQ(near_map.tiles().size(), far_map.tiles().size());
  const Cloud cloud = extract_points(far_map).value();
  ASSERT_GT(cloud.size(), 1000u);
  for (const Vec3& p : cloud.positions) {
    EXPECT_LT(std::min(std::abs(p.z - 300), std::abs(p.y - far.y - 6.03)), 0.06);
  }
}

TEST_F(MapFileTest, QueriesTakeOnlyWhatIsThere) {
  drive("a.curl", settings(), 12, {0, 0, 2});
  const MapFile map = open("a.curl");
  const MapBox box{{10, 2, -1}, {12, 4, 1}};
  EXPECT_EQ(map.parts_in(box).size(), 1u);
  EXPECT_TRUE(map.parts_in({{0, 0, 50}, {1, 1, 60}}).empty());
  MapExtractSettings extract;
  extract.box = box;
  const Cloud boxed = extract_points(map, extract).value();
  EXPECT_NEAR(static_cast<double>(boxed.size()), 4 / (0.0833 * 0.0833), 100);
  extract.box.reset();
  extract.centre = Vec3{20, 0, 0};
  extract.radius_m = 2;
  extract.normals = true;
  const Cloud around = extract_points(map, extract).value();
  EXPECT_GT(around.size(), 1000u);
  ASSERT_EQ(around.attributes.size(), 3u);
  for (std::size_t i = 0; i < around.size(); ++i) {
    EXPECT_LE(norm(around.positions[i] - *extract.centre), 2);
    EXPECT_GT(around.attributes[2].as_double(i), 0.95);
  }
  extract = {};
  extract.tile = TileKey{1, 0};
  extract.max_level = 0;
  EXPECT_GT(extract_points(map, extract).value().size(), 100u);
  extract.max_points = 10;
  EXPECT_EQ(extract_points(map, extract).error().code, ErrorCode::limit_exceeded);
}

TEST_F(MapFileTest, CutAnywhereItIsRefusedOrGivenInPart) {
  drive("a.curl", settings(), 6, {0, 0, 2});
  const std::vector<std::byte> whole = read_file(path("a.curl")).value();
  const std::size_t tiles = open("a.curl").tiles().size();
  std::set<std::size_t> found;
  for (std::size_t size = 0; size < whole.size(); size += 37) {
    const std::vector<std::byte> cut(whole.begin(),
                                     whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(MapFile::read(cut, "cut"));
    MapReadOptions options;
    options.allow_truncated = true;
    const auto part = MapFile::read(cut, "cut", options);
    if (!part) continue;
    EXPECT_FALSE(part->missing().empty());
    found.insert(part->tiles().size());
    for (std::size_t i = 0; i < part->tiles().size(); ++i) EXPECT_TRUE(part->read_tile(i));
  }
  EXPECT_TRUE(found.contains(tiles));
  EXPECT_GT(found.size(), 3u);
}

TEST_F(MapFileTest, ASecondLapCostsLittle) {
  const MapReport first = drive("a.curl", settings(), 8, {0, 0, 2});
  const auto map = std::make_shared<const MapFile>(open("a.curl"));
  MapBuilder builder = MapBuilder::append(map, settings()).value();
  offer(builder, 8, {0, 0, 2}, 0.07);
  const MapReport second = builder.finish(path("b.curl")).value();
  EXPECT_LT(static_cast<double>(second.bytes), 1.1 * static_cast<double>(first.bytes));
  EXPECT_GT(second.explained, 0u);
  EXPECT_EQ(open("b.curl").header().scans, 16u);
}

TEST_F(MapFileTest, TheSameScansAgainChangeNoTile) {
  drive("a.curl", settings(), 4, {0, 0, 2});
  const auto map = std::make_shared<const MapFile>(open("a.curl"));
  MapBuilder builder = MapBuilder::append(map, settings()).value();
  offer(builder, 4, {0, 0, 2});
  const MapReport report = builder.finish(path("b.curl")).value();
  EXPECT_EQ(report.tiles_kept, report.tiles);
  const MapFile after = open("b.curl");
  ASSERT_EQ(after.tiles().size(), map->tiles().size());
  for (std::size_t i = 0; i < after.tiles().size(); ++i) {
    EXPECT_EQ(map->read_part(i).value(), after.read_part(i).value());
  }
}

TEST_F(MapFileTest, AppendingKeepsUntouchedTilesAndMendsDamagedOnes) {
  drive("a.curl", settings(), 4, {0, 0, 2});
  std::vector<std::byte> bytes = read_file(path("a.curl")).value();
  const MapFile before = open("a.curl");
  const IndexedFile parts = IndexedFile::open(random_access_of(bytes, "a")).value();
  bytes[static_cast<std::size_t>(parts.entries()[0].offset) + 5] ^= std::byte{1};
  const auto damaged = std::make_shared<const MapFile>(MapFile::read(bytes, "a").value());
  EXPECT_EQ(damaged->read_tile(0).error().code, ErrorCode::corrupt);
  EXPECT_TRUE(damaged->read_tile(1));
  MapBuilder builder = MapBuilder::append(damaged, settings()).value();
  offer(builder, 2, {200, 0, 2});
  const MapReport report = builder.finish(path("b.curl")).value();
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], HasSubstr("left out"));
  const MapFile after = open("b.curl");
  std::size_t same = 0;
  for (std::size_t i = 1; i < before.tiles().size(); ++i) {
    for (std::size_t j = 0; j < after.tiles().size(); ++j) {
      if (after.tiles()[j].key != before.tiles()[i].key) continue;
      same += before.read_part(i).value() == after.read_part(j).value();
    }
  }
  EXPECT_EQ(same, before.tiles().size() - 1);
  EXPECT_GT(after.tiles().size(), before.tiles().size());
}

TEST_F(MapFileTest, TakesEveryNthScanOrOneEveryFewMetres) {
  MapBuildSettings third = settings(), far = settings();
  third.every_scans = 3;
  far.every_m = 9;
  EXPECT_EQ(drive("a.curl", third, 8, {0, 0, 2}).taken, 3u);
  const MapReport report = drive("b.curl", far, 8, {0, 0, 2});
  EXPECT_EQ(report.taken, 4u);
  EXPECT_EQ(report.offered, 8u);
  EXPECT_NEAR(open("b.curl").header().travelled_m, 35, 1e-9);
}

TEST_F(MapFileTest, KeyframesComeBackWithTheirPoses) {
  SensorProfile sensor;
  sensor.name = "small";
  sensor.columns = 128;
  sensor.max_range_m = 100;
  for (int i = 0; i < 12; ++i) {
    sensor.rings.push_back({.elevation = (10 - 2.5 * i) * std::numbers::pi / 180});
  }
  sensor.fov_up = sensor.rings.front().elevation;
  sensor.fov_down = sensor.rings.back().elevation;
  const Cloud scan = simulate(**make_scene("street"), sensor).value();
  MapBuildSettings scans = settings();
  scans.header.kind = MapKind::scans;
  scans.scan.compact.coverage = Coverage::image;
  scans.scan.compact.columns = 128;
  scans.scan.sensor = sensor;
  MapBuilder builder = MapBuilder::create(scans).value();
  const std::vector<double> yaws = {0, 1, 3.1, -2};
  for (std::size_t i = 0; i < yaws.size(); ++i) {
    const RigidMotion pose = pose_at({10.0 * static_cast<double>(i), 1, 2}, yaws[i]);
    ASSERT_TRUE(builder.add_scan(scan, pose, 0.1 * static_cast<double>(i)));
  }
  ASSERT_TRUE(builder.finish(path("a.curl")));
  const MapFile map = open("a.curl");
  ASSERT_EQ(map.scans().size(), 4u);
  for (std::size_t i = 0; i < yaws.size(); ++i) {
    const MapScan back = map.read_scan(i).value();
    const RigidMotion pose = pose_at({10.0 * static_cast<double>(i), 1, 2}, yaws[i]);
    EXPECT_EQ(back.T_map_sensor.move, pose.move);
    EXPECT_EQ(back.T_map_sensor.rotation, coded_pose(pose).rotation);
    for (std::size_t row = 0; row < 3; ++row) {
      EXPECT_LT(norm(back.T_map_sensor.rotation[row] - pose.rotation[row]), 1e-8);
    }
    EXPECT_EQ(back.time_s, 0.1 * static_cast<double>(i));
    const auto decoded = decode(back.file);
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->points.size(), map.scans()[i].points);
    for (const Vec3& p : decoded->points) {
      const Vec3 placed = back.T_map_sensor(p);
      EXPECT_LE(placed.x, map.scans()[i].box.high.x);
      EXPECT_GE(placed.y, map.scans()[i].box.low.y);
    }
  }
}

TEST_F(MapFileTest, HeadersAndSummariesOfOtherSizesAreRefused) {
  MapHeader header = settings().header;
  const std::vector<std::byte> bytes = write_map_header(header).value();
  ASSERT_TRUE(read_map_header(MapKind::surface, bytes, "m"));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(read_map_header(MapKind::surface, ByteSpan(bytes).first(size), "m")) << size;
  }
  header.surface.step_m = -1;
  EXPECT_EQ(write_map_header(header).error().code, ErrorCode::invalid_argument);
  header = settings().header;
  const std::vector<std::byte> part = write_scan_part(pose_at({1, 2, 3}, 1), 5.0, {});
  ASSERT_TRUE(read_scan_part(part, "m"));
  for (std::size_t size = 0; size < part.size(); ++size) {
    EXPECT_FALSE(read_scan_part(ByteSpan(part).first(size), "m"));
  }
  const auto summary = write_scan_summary(pose_at({1, 2, 3}), header, 20, 1000);
  for (std::size_t size = 0; size < summary.size(); ++size) {
    EXPECT_FALSE(read_scan_summary(ByteSpan(summary).first(size), header, "m"));
  }
}

TEST_F(MapFileTest, PosesThatAreNoneAreRefused) {
  MapBuilder builder = MapBuilder::create(settings()).value();
  RigidMotion pose = pose_at({0, 0, 2});
  pose.rotation[1] = {};
  EXPECT_EQ(builder.add_scan({}, pose).error().code, ErrorCode::invalid_argument);
  pose = pose_at({std::nan(""), 0, 0});
  EXPECT_EQ(builder.add_scan({}, pose).error().code, ErrorCode::invalid_argument);
  EXPECT_TRUE(builder.add_scan({}, pose_at({0, 0, 2})));
  ASSERT_TRUE(builder.finish(path("empty.curl")));
  EXPECT_TRUE(open("empty.curl").tiles().empty());
  EXPECT_FALSE(open("empty.curl").extent());
}

}  // namespace
}  // namespace curlidar
