// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "curlidar/sensor.hpp"

namespace curlidar {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

SensorProfile small_sensor() {
  SensorProfile sensor;
  sensor.name = "small";
  sensor.rings = {{0.1, 0, 0, 0}, {0.0, 0, 0, 0}, {-0.1, 0, 0, 0}};
  sensor.fov_up = 0.1;
  sensor.fov_down = -0.1;
  return sensor;
}

TEST(Validate, AcceptsASoundProfile) {
  EXPECT_TRUE(validate(small_sensor()));
  SensorProfile flat = small_sensor();
  flat.rings.resize(1);
  flat.fov_up = flat.fov_down = 0.1;
  EXPECT_TRUE(validate(flat));
}

TEST(Validate, RefusesWhatConsumersCannotUse) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto broken = [](auto change) {
    SensorProfile sensor = small_sensor();
    change(sensor);
    return !validate(sensor);
  };
  EXPECT_TRUE(broken([](SensorProfile& s) { s.rings.clear(); }));
  EXPECT_TRUE(broken([](SensorProfile& s) { s.rings.resize(kMaxRings + 1); }));
  EXPECT_TRUE(broken([](SensorProfile& s) { s.rings[1].elevation = 0.1; }));
  EXPECT_TRUE(broken([](SensorProfile& s) { s.rings[0].elevation = 1.6; }));
  EXPECT_TRUE(broken([&](SensorProfile& s) { s.rings[1].elevation = nan; }));
  EXPECT_TRUE(broken([&](SensorProfile& s) { s.rings[1].azimuth_offset = nan; }));
  EXPECT_TRUE(broken([](SensorProfile& s) { s.rings[1].vertical_offset_m = 1e9; }));
  EXPECT_TRUE(broken([](SensorProfile& s) { s.columns = 3; }));
  EXPECT_TRUE(broken([](SensorProfile& s) { s.columns = 65537; }));
  EXPECT_TRUE(broken([](SensorProfile& s) { s.fov_up = s.fov_down; }));
  EXPECT_TRUE(broken([&](SensorProfile& s) { s.fov_up = nan; }));
  EXPECT_TRUE(broken([](SensorProfile& s) { s.min_range_m = -1; }));
  EXPECT_TRUE(broken([](SensorProfile& s) { s.max_range_m = s.min_range_m; }));
  EXPECT_TRUE(
      broken([](SensorProfile& s) { s.max_range_m = std::numeric_limits<double>::infinity(); }));
}

TEST(Profile, ApparentElevationAllowsForTheBeamsOrigin) {
  SensorProfile sensor = small_sensor();
  EXPECT_DOUBLE_EQ(sensor.apparent_elevation(0, 10), 0.1);
  sensor.rings[1].vertical_offset_m = 0.2;
  EXPECT_NEAR(sensor.apparent_elevation(1, 10), std::atan(0.02), 1e-12);
}

TEST(Catalogue, HoldsEverySensorItPromises) {
  EXPECT_THAT(builtin_sensor_names(),
              testing::IsSupersetOf(
                  {"hdl64e-kitti", "hdl64e-s2",   "hdl64e-s3",  "hdl32e",     "vlp16",
                   "vlp32c",       "vls128",      "os0-32",     "os0-64",     "os0-128",
                   "os1-32",       "os1-64",      "os1-128",    "os2-32",     "os2-64",
                   "os2-128",      "os1-64-gen1", "pandar40p",  "pandar64",   "pandar128",
                   "pandarqt64",   "pandarqt128", "pandarxt16", "pandarxt32", "superrso16"}));
}

TEST(Catalogue, EveryProfileIsSound) {
  for (const std::string& name : builtin_sensor_names()) {
    const auto sensor = builtin_sensor(name);
    ASSERT_TRUE(sensor) << name << ": " << sensor.error().message;
    EXPECT_EQ(sensor->name, name);
    EXPECT_FALSE(sensor->description.empty()) << name;
    EXPECT_TRUE(validate(*sensor)) << name;
    EXPECT_EQ(sensor->elevations().size(), sensor->rings.size());
  }
}

TEST(Catalogue, KnowsKittisSensor) {
  const auto sensor = builtin_sensor("hdl64e-kitti");
  ASSERT_TRUE(sensor);
  ASSERT_EQ(sensor->rings.size(), 64u);
  EXPECT_EQ(sensor->columns, 2083u);
  EXPECT_DOUBLE_EQ(sensor->fov_up, 2.0 * kDegree);
  EXPECT_DOUBLE_EQ(sensor->fov_down, -24.9 * kDegree);
  EXPECT_EQ(sensor->max_range_m, 120);
  EXPECT_NEAR(sensor->rings.front().elevation, 1.937 * kDegree, 0.001 * kDegree);
  EXPECT_NEAR(sensor->rings.back().elevation, -24.999 * kDegree, 0.001 * kDegree);
  // Two blocks of lasers, one above the other.
  EXPECT_NEAR(sensor->rings[31].vertical_offset_m, 0.198, 0.001);
  EXPECT_NEAR(sensor->rings[32].vertical_offset_m, 0.126, 0.001);
  EXPECT_EQ(sensor->rings[0].horizontal_offset_m, -0.026);
}

TEST(Catalogue, TurnsClockwiseAzimuthsAround) {
  // The calibration files of Hesai and Velodyne count clockwise, the latter with a minus.
  EXPECT_NEAR(builtin_sensor("pandar40p")->rings[0].azimuth_offset, 1.042 * kDegree, 1e-9);
  EXPECT_NEAR(builtin_sensor("vlp32c")->rings[0].azimuth_offset, 1.4 * kDegree, 1e-6);
}

TEST(Catalogue, SuperRsoRowsAreEveryFourthOfSixtyFour) {
  const auto sensor = builtin_sensor("superrso16");
  ASSERT_TRUE(sensor);
  ASSERT_EQ(sensor->rings.size(), 16u);
  const double step = 2 * 16.6 * kDegree / 63;
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_NEAR(sensor->rings[i].elevation, 16.6 * kDegree - step * static_cast<double>(4 * i + 3),
                1e-12);
  }
}

TEST(Catalogue, AcceptsOtherSpellings) {
  for (const auto& [spelling, name] :
       std::vector<std::pair<const char*, const char*>>{{"VLP-16", "vlp16"},
                                                        {"xt16", "pandarxt16"},
                                                        {"QT64", "pandarqt64"},
                                                        {"OS1_64", "os1-64"},
                                                        {"pandar_xt32", "pandarxt32"},
                                                        {"HDL-32E", "hdl32e"}}) {
    const auto sensor = builtin_sensor(spelling);
    ASSERT_TRUE(sensor) << spelling;
    EXPECT_EQ(sensor->name, name);
  }
}

TEST(Catalogue, UnknownNamesSuggestNearOnes) {
  const auto sensor = builtin_sensor("vlp17");
  ASSERT_FALSE(sensor);
  EXPECT_EQ(sensor.error().code, ErrorCode::not_found);
  EXPECT_THAT(sensor.error().message, testing::HasSubstr("vlp16"));
  EXPECT_FALSE(builtin_sensor(""));
  EXPECT_FALSE(builtin_sensor(std::string(1 << 20, 'x')));
}

TEST(Catalogue, LimitedFieldScannersAreUnsupported) {
  for (const char* name : {"livox", "Livox-Avia", "mid360", "pandarat128", "AT128"}) {
    const auto sensor = builtin_sensor(name);
    ASSERT_FALSE(sensor) << name;
    EXPECT_EQ(sensor.error().code, ErrorCode::unsupported) << name;
    EXPECT_THAT(sensor.error().message, testing::HasSubstr("limited-field"));
  }
}

}  // namespace
}  // namespace curlidar
