// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "unit/sensor/synthetic.hpp"

namespace curlidar {
namespace {

using test::make_scan;
using test::Random;
using test::Synthetic;

constexpr double kDegree = std::numbers::pi / 180;

/// A sensor that is not built in: rings further apart at the outside.
SensorProfile unknown_sensor() {
  SensorProfile sensor;
  sensor.name = "unknown";
  for (int i = 0; i < 24; ++i) {
    const double t = (11.5 - i) / 11.5;
    sensor.rings.push_back({(8 * t + 9 * t * t * t) * kDegree, 0, 0, 0});
  }
  sensor.columns = 900;
  sensor.fov_up = sensor.rings.front().elevation;
  sensor.fov_down = sensor.rings.back().elevation;
  return sensor;
}

Attribute attribute_of(const char* name, const std::vector<std::uint16_t>& values) {
  return {name, 1, Column(values)};
}

TEST(DetectSensor, RefusesACloudWithoutReturns) {
  Cloud cloud;
  EXPECT_FALSE(detect_sensor(cloud));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  cloud.positions = {{0, 0, 0}, {nan, 1, 1}};
  cloud.width = 2;
  const auto detection = detect_sensor(cloud);
  ASSERT_FALSE(detection);
  EXPECT_EQ(detection.error().code, ErrorCode::invalid_argument);
}

TEST(DetectSensor, CopesWithTheFewestPoints) {
  Cloud cloud;
  for (const Vec3& p : {Vec3{1, 0, 0}, Vec3{0, 2, 1}, Vec3{-3, 0, -1}}) {
    cloud.positions.push_back(p);
    cloud.width = static_cast<std::uint32_t>(cloud.size());
    const auto detection = detect_sensor(cloud);
    ASSERT_TRUE(detection) << detection.error().message;
    EXPECT_TRUE(validate(detection->sensor));
    EXPECT_EQ(detection->ring_of_point.size(), cloud.size());
    for (const std::uint16_t ring : detection->ring_of_point) {
      EXPECT_LT(ring, detection->sensor.rings.size());
    }
  }
}

TEST(DetectSensor, StraightUpAndIdenticalPointsAreNoTrouble) {
  Cloud cloud;
  cloud.positions.assign(100, {0, 0, 5});
  cloud.width = 100;
  const auto up = detect_sensor(cloud);
  ASSERT_TRUE(up) << up.error().message;
  cloud.positions.push_back({0, 0, -5});
  cloud.width = 101;
  const auto both = detect_sensor(cloud);
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_TRUE(validate(both->sensor));
}

TEST(DetectSensor, CountsSlotsAndMeasuresRanges) {
  Synthetic scan = make_scan(unknown_sensor());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  scan.cloud.positions[5] = {0, 0, 0};
  scan.cloud.positions[9] = {nan, nan, nan};
  scan.cloud.positions[10] = {1, std::numeric_limits<double>::infinity(), 0};
  const auto d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->points, scan.cloud.size());
  EXPECT_EQ(d->zero, 1u);
  EXPECT_EQ(d->not_finite, 2u);
  EXPECT_EQ(d->returns, scan.cloud.size() - 3);
  EXPECT_EQ(d->ring_of_point[5], kNoRing);
  EXPECT_EQ(d->ring_of_point[9], kNoRing);
  EXPECT_THAT(d->notes, testing::Contains(testing::HasSubstr("1 (0,0,0) slot")));
  EXPECT_DOUBLE_EQ(d->azimuth_coverage, 1);
  EXPECT_NEAR(d->range_min_m, 4, 0.1);
  EXPECT_NEAR(d->range_p50_m, 22, 0.5);
  EXPECT_NEAR(d->range_p90_m, 36.4, 0.5);
  EXPECT_NEAR(d->range_max_m, 40, 0.1);
  EXPECT_LE(d->occupancy, 1);
  EXPECT_GT(d->occupancy, 0.98);
}

TEST(DetectSensor, UsesARingAttributeUnderAnyNumbering) {
  Synthetic scan = make_scan(unknown_sensor());
  test::shuffle(scan);
  std::vector<std::uint16_t> numbers(scan.ring);
  for (const char* name : {"ring", "channel", "laser_id", "line"}) {
    scan.cloud.attributes = {attribute_of(name, numbers)};
    const auto d = detect_sensor(scan.cloud);
    ASSERT_TRUE(d);
    EXPECT_EQ(d->source, RingSource::ring_attribute) << name;
    EXPECT_EQ(d->sensor.name, "auto");
    EXPECT_EQ(test::agreement(scan, *d), 1.0);
    // From the bottom, from 1, or in an order of its own.
    for (std::uint16_t& number : numbers) number = static_cast<std::uint16_t>(24 - number);
    if (std::string(name) == "laser_id") {
      for (std::uint16_t& number : numbers) number = static_cast<std::uint16_t>(number * 7 % 24);
    }
  }
}

TEST(DetectSensor, MeasuresElevationsAndColumnsOfUnknownRings) {
  const SensorProfile sensor = unknown_sensor();
  Synthetic scan = make_scan(sensor);
  scan.cloud.attributes = {attribute_of("ring", scan.ring)};
  const auto d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d);
  ASSERT_EQ(d->sensor.rings.size(), 24u);
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_NEAR(d->sensor.rings[i].elevation, sensor.rings[i].elevation, 0.01 * kDegree);
    EXPECT_NEAR(d->ring_elevations[i], sensor.rings[i].elevation, 0.01 * kDegree);
  }
  EXPECT_EQ(d->sensor.columns, 900u);
  EXPECT_EQ(d->sensor.fov_up, d->sensor.rings.front().elevation);
  EXPECT_EQ(d->sensor.fov_down, d->sensor.rings.back().elevation);
}

TEST(DetectSensor, IgnoresAnAttributeThatIsNoRing) {
  Synthetic scan = make_scan(unknown_sensor());
  // Livox numbers its six lines; each sees the whole field of view.
  Random random(3);
  std::vector<std::uint16_t> line;
  for (std::size_t i = 0; i < scan.ring.size(); ++i) {
    line.push_back(static_cast<std::uint16_t>(random.below(6)));
  }
  scan.cloud.attributes = {attribute_of("line", line)};
  const auto by_line = detect_sensor(scan.cloud);
  ASSERT_TRUE(by_line);
  EXPECT_EQ(by_line->source, RingSource::azimuth_wraps);
  EXPECT_THAT(by_line->notes, testing::Contains(testing::HasSubstr("\"line\"")));

  scan.cloud.attributes = {{"ring", 1, Column(std::vector<float>(scan.ring.size(), 0.5f))}};
  EXPECT_EQ(detect_sensor(scan.cloud)->source, RingSource::azimuth_wraps);
  scan.cloud.attributes = {{"ring", 1, Column(std::vector<double>(scan.ring.size(), 1e300))}};
  EXPECT_EQ(detect_sensor(scan.cloud)->source, RingSource::azimuth_wraps);
  scan.cloud.attributes = {{"ring", 1, Column(std::vector<float>(scan.ring.size(), 0))}};
  EXPECT_EQ(detect_sensor(scan.cloud)->source, RingSource::azimuth_wraps);
}

TEST(DetectSensor, UsesTheRowsOfOrganisedClouds) {
  Synthetic scan = make_scan(unknown_sensor());
  scan.cloud.width = 900;
  scan.cloud.height = 24;
  const auto rows = detect_sensor(scan.cloud);
  ASSERT_TRUE(rows);
  EXPECT_EQ(rows->source, RingSource::organised_rows);
  EXPECT_EQ(rows->sensor.columns, 900u);
  EXPECT_EQ(test::agreement(scan, *rows), 1.0);

  Synthetic turned = scan;
  for (std::size_t row = 0; row < 24; ++row) {
    for (std::size_t column = 0; column < 900; ++column) {
      turned.cloud.positions[column * 24 + row] = scan.cloud.positions[row * 900 + column];
      turned.ring[column * 24 + row] = static_cast<std::uint16_t>(row);
    }
  }
  turned.cloud.width = 24;
  turned.cloud.height = 900;
  const auto columns = detect_sensor(turned.cloud);
  ASSERT_TRUE(columns);
  EXPECT_EQ(columns->source, RingSource::organised_rows);
  EXPECT_EQ(columns->sensor.columns, 900u);
  EXPECT_EQ(test::agreement(turned, *columns), 1.0);
}

TEST(DetectSensor, RowsWithoutReturnsKeepTheirPlace) {
  Synthetic scan = make_scan(unknown_sensor());
  scan.cloud.width = 900;
  scan.cloud.height = 24;
  for (const std::size_t row : {0u, 1u, 10u, 23u}) {
    for (std::size_t column = 0; column < 900; ++column) {
      scan.cloud.positions[row * 900 + column] = {0, 0, 0};
      scan.ring[row * 900 + column] = kNoRing;
    }
  }
  const auto d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d);
  ASSERT_EQ(d->sensor.rings.size(), 24u);
  EXPECT_EQ(test::agreement(scan, *d), 1.0);
  EXPECT_TRUE(validate(d->sensor));
}

TEST(DetectSensor, CountsTurnsInFileOrder) {
  Synthetic scan = make_scan(unknown_sensor());
  scan.cloud.positions.push_back({0, 0, 0});  // as KITTI's files have; it is no ring
  scan.cloud.width += 1;
  auto d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->source, RingSource::azimuth_wraps);
  EXPECT_EQ(d->sensor.rings.size(), 24u);
  EXPECT_EQ(test::agreement(scan, *d), 1.0);
  // Bottom ring first and clockwise.
  std::reverse(scan.cloud.positions.begin(), scan.cloud.positions.end());
  std::reverse(scan.ring.begin(), scan.ring.end());
  scan.ring.insert(scan.ring.begin(), kNoRing);
  d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->source, RingSource::azimuth_wraps);
  EXPECT_EQ(test::agreement(scan, *d), 1.0);
}

TEST(DetectSensor, CountsTurnsOfACroppedScan) {
  test::SyntheticOptions front;
  front.azimuth_from = 60 * kDegree;
  front.azimuth_to = 150 * kDegree;
  const Synthetic scan = make_scan(unknown_sensor(), front);
  const auto d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->source, RingSource::azimuth_wraps);
  EXPECT_EQ(d->sensor.rings.size(), 24u);
  EXPECT_EQ(d->sensor.columns, 900u);
  EXPECT_EQ(test::agreement(scan, *d), 1.0);
  EXPECT_EQ(d->sensor.pattern, ScanPattern::spinning);
  EXPECT_THAT(d->notes, testing::Contains(testing::HasSubstr("90 of 360 degrees")));
}

TEST(DetectSensor, FindsClustersInAnyOrder) {
  Synthetic scan = make_scan(unknown_sensor());
  test::shuffle(scan);
  const auto d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->source, RingSource::clustered);
  EXPECT_EQ(d->sensor.name, "auto");
  ASSERT_EQ(d->sensor.rings.size(), 24u);
  EXPECT_GT(test::agreement(scan, *d), 0.999);
  EXPECT_EQ(d->sensor.columns, 900u);
}

TEST(DetectSensor, APlanarScanIsOneRing) {
  SensorProfile flat = unknown_sensor();
  flat.rings = {{0.02, 0, 0, 0}};
  flat.fov_up = flat.fov_down = 0.02;
  Synthetic scan = make_scan(flat);
  const auto d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->sensor.rings.size(), 1u);
  EXPECT_NEAR(d->sensor.rings[0].elevation, 0.02, 1e-4);
}

TEST(DetectSensor, WithoutRingsRowsAreUniform) {
  Cloud cloud;
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    cloud.positions.push_back(
        direction_of(-1.0 + 2.0 * random.uniform(), -3.14 + 6.28 * random.uniform()) *
        (2 + random.uniform()));
  }
  cloud.width = 20000;
  const auto d = detect_sensor(cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->source, RingSource::uniform);
  EXPECT_EQ(d->sensor.pattern, ScanPattern::spinning);
  EXPECT_EQ(d->sensor.fov_up, d->elevation_max);
  EXPECT_EQ(d->sensor.fov_down, d->elevation_min);
  EXPECT_GE(d->sensor.rings.size(), 32u);
  EXPECT_LE(d->sensor.rings.size(), 256u);
}

TEST(DetectSensor, ARosetteIsALimitedField) {
  Cloud cloud;
  for (int i = 0; i < 30000; ++i) {  // the flower of two prisms turning at different speeds
    const double a = 0.0613 * i, b = -0.0447 * i;
    const double y = 0.33 * std::cos(a) + 0.33 * std::cos(b);
    const double z = 0.33 * std::sin(a) + 0.33 * std::sin(b);
    cloud.positions.push_back(Vec3{1, y, z} * (5 + 20 * std::abs(std::sin(0.001 * i))));
  }
  cloud.width = 30000;
  const auto d = detect_sensor(cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->source, RingSource::uniform);
  EXPECT_EQ(d->sensor.pattern, ScanPattern::limited_field);
  EXPECT_THAT(d->notes, testing::Contains(testing::HasSubstr("limited-field")));
  EXPECT_TRUE(validate(d->sensor));
}

TEST(DetectSensor, APinholeImageIsALimitedField) {
  Cloud cloud;
  Random random(9);
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      const double depth = 3 + 4 * random.uniform();
      cloud.positions.push_back(Vec3{1, (80 - u) / 130.0, (60 - v) / 130.0} * depth);
    }
  }
  cloud.width = 160;
  cloud.height = 120;
  const auto d = detect_sensor(cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->sensor.pattern, ScanPattern::limited_field);
}

TEST(DetectSensor, TheSameCloudGivesTheSameAnswer) {
  Synthetic scan = make_scan(unknown_sensor());
  test::shuffle(scan);
  const auto a = detect_sensor(scan.cloud), b = detect_sensor(scan.cloud);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->ring_of_point, b->ring_of_point);
  EXPECT_EQ(a->sensor.elevations(), b->sensor.elevations());
}

/// Every built-in sensor is recognised from scans in three orders.
class DetectBuiltin : public testing::TestWithParam<std::string> {};

test::SyntheticOptions thinned(const SensorProfile& profile) {
  test::SyntheticOptions options;
  options.columns = profile.columns / 2;  // as at twice the speed
  options.noise_deg = 0.01;
  return options;
}

TEST_P(DetectBuiltin, FromFileOrder) {
  const auto profile = builtin_sensor(GetParam());
  ASSERT_TRUE(profile);
  const Synthetic scan = make_scan(*profile);
  const auto d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d) << d.error().message;
  EXPECT_EQ(d->source, RingSource::azimuth_wraps);
  EXPECT_EQ(d->sensor.name, GetParam());
  EXPECT_EQ(d->sensor.columns, profile->columns);
  EXPECT_EQ(test::agreement(scan, *d), 1.0);
}

TEST_P(DetectBuiltin, Shuffled) {
  const auto profile = builtin_sensor(GetParam());
  ASSERT_TRUE(profile);
  Synthetic scan = make_scan(*profile, thinned(*profile));
  test::shuffle(scan);
  const auto d = detect_sensor(scan.cloud);
  ASSERT_TRUE(d) << d.error().message;
  EXPECT_EQ(d->source, RingSource::clustered);
  EXPECT_EQ(d->sensor.name, GetParam());
  EXPECT_GT(test::agreement(scan, *d), 0.99);
}

TEST_P(DetectBuiltin, GivenTheProfile) {
  const auto profile = builtin_sensor(GetParam());
  ASSERT_TRUE(profile);
  const Synthetic scan = make_scan(*profile, thinned(*profile));
  const auto d = assign_rings(scan.cloud, *profile);
  ASSERT_TRUE(d) << d.error().message;
  EXPECT_EQ(d->source, RingSource::profile);
  EXPECT_GT(test::agreement(scan, *d), 0.99);
  EXPECT_THAT(d->notes, testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Sensors, DetectBuiltin, testing::ValuesIn(builtin_sensor_names()),
                         [](const auto& param) {
                           std::string name = param.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(DetectSensor, RecognisesASensorThatMissesRings) {
  const auto profile = builtin_sensor("pandarxt32");
  ASSERT_TRUE(profile);
  Synthetic scan = make_scan(*profile);
  Synthetic low;  // the six upper beams look into the sky
  for (std::size_t i = 0; i < scan.ring.size(); ++i) {
    if (scan.ring[i] < 6) continue;
    low.cloud.positions.push_back(scan.cloud.positions[i]);
    low.ring.push_back(scan.ring[i]);
  }
  low.cloud.width = static_cast<std::uint32_t>(low.cloud.size());
  const auto d = detect_sensor(low.cloud);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->sensor.name, "pandarxt32");
  EXPECT_EQ(test::agreement(low, *d), 1.0);
}

TEST(AssignRings, RefusesABrokenProfile) {
  const Synthetic scan = make_scan(unknown_sensor());
  SensorProfile broken = unknown_sensor();
  broken.rings[3].elevation = 2;
  EXPECT_FALSE(assign_rings(scan.cloud, broken));
  EXPECT_FALSE(assign_rings(Cloud{}, unknown_sensor()));
}

TEST(AssignRings, SaysWhenTheProfileDoesNotFit) {
  const Synthetic scan = make_scan(*builtin_sensor("os0-64"));
  const auto d = assign_rings(scan.cloud, *builtin_sensor("os2-64"));
  ASSERT_TRUE(d);
  EXPECT_THAT(d->notes, testing::Contains(testing::HasSubstr("two ring steps")));
}

}  // namespace
}  // namespace curlidar
