// SPDX-License-Identifier: BSD-3-Clause
// What the measurements of the report stand on: arguments, aiming at directions, splitting rings,
// counting errors.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "curlidar/simulate.hpp"
#include "report/measure/arguments.hpp"
#include "report/measure/held_out.hpp"
#include "report/measure/methods.hpp"

namespace curlidar::bench {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Even rings from +0.2 radians down in steps of 0.05, `height_m` above the origin.
SensorProfile small_sensor(std::size_t rings, double height_m = 0) {
  SensorProfile sensor;
  sensor.name = "small";
  sensor.columns = 64;
  for (std::size_t i = 0; i < rings; ++i) {
    sensor.rings.push_back(
        {.elevation = 0.2 - 0.05 * static_cast<double>(i), .vertical_offset_m = height_m});
  }
  sensor.fov_up = 0.2;
  sensor.fov_down = sensor.rings.back().elevation;
  return sensor;
}

/// A field whose beams start above the origin, everywhere as far away.
class RaisedField final : public Field {
 public:
  static constexpr double kRange_m = 4, kHeight_m = 0.3;
  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double, std::span<const double> columns, bool,
                    std::span<double> ranges) const override {
    for (std::size_t i = 0; i < columns.size(); ++i) ranges[i] = kRange_m;
  }
  void place_row(double row, std::span<const double> columns, std::span<const double> ranges,
                 std::span<Vec3> points) const override {
    Field::place_row(row, columns, ranges, points);
    for (Vec3& p : points) p.z += kHeight_m;
  }
  bool occupied(std::uint32_t, std::uint32_t) const override { return true; }

 private:
  Lattice lattice_ = Lattice::from_rings(small_sensor(9).elevations(), 64);
};

TEST(Arguments, AreWordsAndOptions) {
  const auto arguments = parse_arguments({"a.pcd", "--every", "4"}, 1, {"every"});
  ASSERT_TRUE(arguments);
  EXPECT_EQ(arguments->words, std::vector<std::string>{"a.pcd"});
  EXPECT_EQ(*arguments->number("every", 2, 2, 64), 4u);
  EXPECT_EQ(*arguments->number("runs", 5, 1, 10), 5u);
  EXPECT_FALSE(arguments->number("every", 2, 5, 64));
}

TEST(Arguments, AreRefusedIfTheyMakeNoSense) {
  EXPECT_FALSE(parse_arguments({}, 1, {"every"}));
  EXPECT_FALSE(parse_arguments({"a", "b"}, 1, {"every"}));
  EXPECT_FALSE(parse_arguments({"a", "--every"}, 1, {"every"}));
  EXPECT_FALSE(parse_arguments({"a", "--evry", "4"}, 1, {"every"}));
}

TEST(Factors, AreNumbersBetweenCommas) {
  EXPECT_EQ(*parse_factors("2,4.5,8"), (std::vector<double>{2, 4.5, 8}));
  for (const char* bad : {"", "2,x", "0", "-1", "65", "2,,4"})
    EXPECT_FALSE(parse_factors(bad)) << bad;
}

TEST(FieldSampler, FindsTheBeamThatEndsInADirection) {
  DecodedScan scan;
  scan.field = std::make_shared<RaisedField>();
  const Vec3 direction = direction_of(0.11, 1.234);
  const double range = FieldSampler(scan).range(direction);
  EXPECT_NEAR(norm(direction * range - Vec3{0, 0, RaisedField::kHeight_m}), RaisedField::kRange_m,
              1e-5);
}

TEST(SplitRings, KeepsEveryNthAndLeavesOutThoseBelowTheLast) {
  const SensorProfile sensor = small_sensor(8);
  Cloud cloud;
  for (const Ring& ring : sensor.rings) {
    cloud.positions.push_back(direction_of(ring.elevation, 0.5) * 7);
  }
  cloud.positions.push_back({0, 0, 0});
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  const Detection detection = assign_rings(cloud, sensor).value();
  const RingSplit split = split_rings(cloud, detection, 3);  // rings 0, 3, 6; ring 7 below
  EXPECT_EQ(split.ring_of_point, (std::vector<std::uint16_t>{0, 1, 2}));
  ASSERT_EQ(split.coded.size(), 3u);
  EXPECT_EQ(split.coded.positions[1], cloud.positions[3]);
  ASSERT_EQ(split.sensor.rings.size(), 3u);
  EXPECT_EQ(split.sensor.rings[2].elevation, sensor.rings[6].elevation);
  EXPECT_EQ(split.held_out.size(), 4u);
  EXPECT_TRUE(validate(split.sensor));
}

TEST(RayTally, CountsWhatIsToldWithinTheLimits) {
  RayTally tally({1, 10});
  tally.add(5.0, 5.01);          // a good point
  tally.add(5.0, 30.0);          // the surface is beyond the limits: counts as an error
  tally.add(5.0, std::nullopt);  // no surface
  tally.add(kNan, 6.0);          // missed
  tally.add(12.0, 6.0);          // told outside: as good as missed
  tally.add(kNan, 40.0);         // nothing to find there
  const RayErrors errors = tally.errors();
  EXPECT_EQ(errors.points, 3u);
  EXPECT_EQ(errors.stats.count, 2u);
  EXPECT_NEAR(errors.stats.mean, (0.01 + 25) / 2, 1e-12);
  EXPECT_DOUBLE_EQ(errors.within_5cm, 0.5);
  EXPECT_DOUBLE_EQ(errors.completeness, 1.0 / 3);
  EXPECT_EQ(errors.no_surface, 1u);
}

TEST(Methods, AllTellRangesBetweenTheRowsOfARoom) {
  const SensorProfile sensor = small_sensor(16);
  const auto room = make_scene("room").value();
  const Cloud cloud = simulate(*room, sensor).value();
  const Detection rings = assign_rings(cloud, sensor).value();
  EncodeSettings paper;
  paper.profile = Profile::paper;
  paper.paper = paper_preset("indoor").value();
  paper.paper.columns = sensor.columns;
  paper.paper.cliffs = {1, 1, 1.5};
  paper.paper.outlier_radius_m = 0;
  paper.sensor = sensor;
  paper.attributes.emplace();
  for (const Method& method : make_methods({.cloud = &cloud,
                              .paper = paper,
                              .compact_sensor = sensor,
                              .ring_of_point = rings.ring_of_point,
                              .ring_elevations = rings.ring_elevations,
                              .columns = sensor.columns})) {
    SCOPED_TRACE(method.name + " " + method.setting);
    if (!method.sampler) {
      EXPECT_EQ(method.setting, "1 bit a point") << method.skipped;  // too coarse a sensor for it
      continue;
    }
    const auto rays = method.sampler->between_rows(2);
    ASSERT_TRUE(rays);
    EXPECT_EQ(rays->size(), 15u * sensor.columns);
    // The field says the same on its grid as in any direction.
    std::size_t told = 0, same = 0;
    for (const RayRange& ray : *rays) {
      if (std::isnan(ray.range_m)) continue;
      ++told;
      same += std::abs(method.sampler->range(ray.direction) - ray.range_m) < 1e-3 ? 1 : 0;
    }
    EXPECT_GT(told, rays->size() / 3);
    EXPECT_GT(same, told * 95 / 100);
  }
}

}  // namespace
}  // namespace curlidar::bench
