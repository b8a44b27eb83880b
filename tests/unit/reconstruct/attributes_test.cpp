// SPDX-License-Identifier: BSD-3-Clause
// What comes with invented points: attributes, normals, the originals beside them.
#include "reconstruct/attributes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "support/scene_field.hpp"

namespace curlidar {
namespace {

using test::BoxScene;

/// Every point stands on the first two cells, three quarters on the second.
class TwoSources : public test::SceneField {
 public:
  using SceneField::SceneField;
  Sources sources_at(const Vec3&) const override {
    Sources sources;
    sources.cell = {0, 1};
    sources.weight = {0.25, 0.75};
    return sources;
  }
};

TEST(ReconstructAttributes, MeasuredOnesAreInterpolatedOthersAreTheNearest) {
  DecodedScan scan;
  scan.field = std::make_shared<TwoSources>(std::make_shared<BoxScene>(), test::small_sensor());
  const float nan = std::nanf("");
  scan.attributes = {{"intensity", 1, std::vector<float>{1, 2}},
                     {"reflectivity", 1, std::vector<std::uint8_t>{10, 20}},
                     {"ring", 1, std::vector<std::uint16_t>{3, 7}},
                     {"time", 1, std::vector<float>{0.5F, 0.6F}},
                     {"rgb", 1, std::vector<std::uint32_t>{0xff0000, 0x00ff00}},
                     {"stamp_ns", 1, std::vector<std::int64_t>{1, 5}},
                     {"big", 1, std::vector<std::int64_t>{1, 5}},
                     {"holes", 1, std::vector<float>{4, nan}},
                     {"pair", 2, std::vector<double>{0, 100, 4, 300}}};
  for (Attribute& a : scan.attributes) {
    std::visit([&](auto& v) { v.resize(scan.field->lattice().cells() * a.components); }, a.values);
  }
  const std::vector<Vec3> points{{8, 0, 0}, {std::nan(""), 0, 0}};
  const std::vector<Attribute> got = attributes_at(scan, *scan.field, points, 1);
  const std::vector<double> wanted{1.75, 18, 7, 0.6F, 0x00ff00, 5, 5, 4, 3};
  ASSERT_EQ(got.size(), wanted.size());
  for (std::size_t a = 0; a < got.size(); ++a) {
    EXPECT_EQ(got[a].as_double(0), wanted[a]) << got[a].name;
    EXPECT_EQ(got[a].as_double(1), 0) << got[a].name;
  }
  EXPECT_EQ(std::get<std::vector<double>>(got.back().values)[1], 250);
}

TEST(ReconstructAttributes, OfADenseCompactScanLieBetweenThoseOfTheReturns) {
  const auto scene = make_scene("room").value();
  const SensorProfile sensor = test::small_sensor();
  const DecodedScan scan = test::compact_scan(*scene, sensor);
  const Cloud coded = reconstruct(scan).value(), dense = reconstruct(scan, {.rows = 2}).value();
  const auto values = [](const Cloud& cloud, const char* name) {
    std::set<double> out;
    for (std::size_t i = 0; i < cloud.size(); ++i) out.insert(cloud.find(name)->as_double(i));
    return out;
  };
  EXPECT_EQ(values(dense, "ring"), values(coded, "ring"));
  const std::set<double> times = values(coded, "time");
  for (const double time : values(dense, "time")) ASSERT_TRUE(times.contains(time));
  EXPECT_GT(values(dense, "intensity").size(), values(coded, "intensity").size());
  EXPECT_GE(*values(dense, "intensity").begin(), *values(coded, "intensity").begin());
  EXPECT_LE(*values(dense, "intensity").rbegin(), *values(coded, "intensity").rbegin());
}

TEST(ReconstructNormals, AreThoseOfThePlanesAndLookAtTheSensor) {
  const DecodedScan scan = test::exact_scan(std::make_shared<BoxScene>(true), test::small_sensor());
  const Cloud cloud = reconstruct(scan, {.rows = 1.5, .normals = true}).value();
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3 n{cloud.find("normal_x")->as_double(i), cloud.find("normal_y")->as_double(i),
                 cloud.find("normal_z")->as_double(i)};
    if (std::isnan(n.x)) {
      ++unknown;
      continue;
    }
    ASSERT_NEAR(norm(n), 1, 1e-6);
    ASSERT_LT(dot(n, cloud.positions[i]), 0);
  }
  EXPECT_LT(unknown, cloud.size() / 50);
  // In the middle of the wall ahead, above and beside the screen.
  const std::vector<Vec3> ahead{{8, 3.5, 0.3}, {8, -3, -0.5}, {4, 0.1, 0.2}};
  const Cloud walls = reconstruct_directions(scan, ahead, {.normals = true}).value();
  for (std::size_t i = 0; i < ahead.size(); ++i) {
    EXPECT_NEAR(walls.find("normal_x")->as_double(i), -1, 1e-6);
  }
}

TEST(ReconstructNormals, OfACompactFileAreCloseToThePlanes) {
  const DecodedScan scan = test::compact_scan(BoxScene(), test::small_sensor(32, 512), 0.01);
  const std::vector<Vec3> directions{{8, 3, 0.3}, {8, -3, -0.5}, {4, -6, 0.1}, {3, 3, -1.5}};
  const Cloud cloud = reconstruct_directions(scan, directions, {.normals = true}).value();
  const auto axis = [&](const char* name, std::size_t i) { return cloud.find(name)->as_double(i); };
  EXPECT_LT(axis("normal_x", 0), -0.95);
  EXPECT_LT(axis("normal_x", 1), -0.95);
  EXPECT_GT(axis("normal_y", 2), 0.95);
  EXPECT_GT(axis("normal_z", 3), 0.95);
}

TEST(ReconstructOriginals, ComeFirstAndAreNotDoubled) {
  const DecodedScan scan = test::exact_scan(std::make_shared<BoxScene>(true), test::small_sensor());
  ReconstructSettings settings{.rows = 3, .columns = 2};
  settings.keep_originals = settings.original = settings.confidence = true;
  settings.field = scan.field;  // as it is: it tells confidences
  const Cloud cloud = reconstruct(scan, settings).value();
  // Of 3 x 2 places one is taken by its return; the two rows above the top have none.
  EXPECT_EQ(cloud.size(), 24u * 256 + (6u * 24 * 256 - 24 * 256));
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    ASSERT_EQ(cloud.positions[i], scan.points[i]);
    ASSERT_EQ(cloud.find("original")->as_double(i), 1);
    ASSERT_EQ(cloud.find("confidence")->as_double(i), 1);
  }
  EXPECT_EQ(cloud.find("original")->as_double(scan.points.size()), 0);
  settings.organised = true;
  EXPECT_EQ(reconstruct(scan, settings).error().code, ErrorCode::invalid_argument);
}

TEST(ReconstructOriginals, OfACompactFileKeepTheirAttributes) {
  const DecodedScan scan = test::compact_scan(BoxScene(), test::small_sensor());
  ReconstructSettings settings{.rows = 2};
  settings.keep_originals = true;
  const Cloud coded = reconstruct(scan).value(), cloud = reconstruct(scan, settings).value();
  ASSERT_GT(cloud.size(), coded.size() * 3 / 2);
  ASSERT_EQ(cloud.attributes.size(), coded.attributes.size());
  for (std::size_t i = 0; i < coded.size(); ++i) {
    ASSERT_EQ(cloud.positions[i], coded.positions[i]);
    for (const Attribute& a : coded.attributes) {
      ASSERT_EQ(cloud.find(a.name)->as_double(i), a.as_double(i));
    }
  }
}

TEST(Reconstruct, OneRowOneColumnAndLess) {
  const SensorProfile single = test::small_sensor(1, 256);
  const DecodedScan scan = test::compact_scan(BoxScene(), single);
  for (const auto& [rows, columns] :
       {std::pair{1.0, 0.001}, {0.001, 1.0}, {3.0, 1.0}, {0.001, 0.001}, {2.5, 0.7}}) {
    const Cloud cloud =
        reconstruct(scan, {.rows = rows, .columns = columns, .organised = true}).value();
    EXPECT_EQ(cloud.size(), std::size_t{cloud.width} * cloud.height);
    EXPECT_GE(cloud.size(), 1u);
    EXPECT_TRUE(reconstruct_mesh(scan, {.rows = rows, .columns = columns}));
  }
  EXPECT_TRUE(reconstruct_density(scan, 100));
  EXPECT_TRUE(reconstruct_sensor(scan, test::small_sensor()));
}

TEST(Reconstruct, AnEmptyScanGivesEmptyClouds) {
  const SensorProfile sensor = test::small_sensor();
  const auto bytes = [&] {
    EncodeSettings settings;
    settings.sensor = sensor;
    settings.compact.effort = 1;
    const Cloud ahead = [&] {
      Cloud cloud = simulate(BoxScene(), sensor).value();
      std::vector<std::uint32_t> kept;
      for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (cloud.positions[i].x > 0) kept.push_back(i);
      }
      return select(cloud, kept);
    }();
    return encode(ahead, settings)->bytes;
  }();
  DecodeOptions behind;
  behind.region = ScanRegion{.azimuth_begin = 2, .azimuth_end = 4};
  const DecodedScan nothing = decode(bytes, behind).value();
  ASSERT_EQ(nothing.coded_returns, 0u);
  ReconstructSettings settings;
  settings.region = behind.region;
  settings.confidence = settings.normals = settings.original = true;
  const std::vector<Vec3> directions{{-1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(reconstruct(nothing, settings)->size(), 0u);
  EXPECT_EQ(count_returns(reconstruct_directions(nothing, directions, settings).value()), 0u);
  EXPECT_EQ(reconstruct_sensor(nothing, sensor, settings)->size(), 0u);
  EXPECT_EQ(reconstruct_density(nothing, 100, settings)->size(), 0u);
  EXPECT_TRUE(reconstruct_mesh(nothing, settings)->vertices.empty());
  settings.rows = 2.5;
  EXPECT_EQ(reconstruct(nothing, settings)->size(), 0u);
  settings.keep_originals = true;
  EXPECT_EQ(reconstruct(nothing, settings)->size(), 0u);
  EXPECT_EQ(reconstruct_density(nothing, 100, settings)->size(), 0u);
}

}  // namespace
}  // namespace curlidar
