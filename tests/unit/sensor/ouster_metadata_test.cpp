// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "curlidar/sensor.hpp"
#include "unit/sensor/synthetic.hpp"

namespace curlidar {
namespace {

using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

const std::string kFlat = R"({
  "beam_altitude_angles": [10.5, 3, -7.25],
  "beam_azimuth_angles": [2.5, 0, -2.5],
  "lidar_mode": "2048x10",
  "lidar_origin_to_beam_origin_mm": 15.806,
  "prod_line": "OS-1-32-G"
})";

const std::string kNested = R"({
  "beam_intrinsics": {
    "beam_altitude_angles": [10.5, 3, -7.25],
    "beam_azimuth_angles": [2.5, 0, -2.5],
    "lidar_origin_to_beam_origin_mm": 15.806
  },
  "config_params": {"lidar_mode": "2048x10"},
  "lidar_data_format": {"columns_per_frame": 2048, "pixels_per_column": 3},
  "sensor_info": {"prod_line": "OS-1-32-G"}
})";

TEST(OusterMetadata, ReadsBothLayoutsAlike) {
  for (const std::string& text : {kFlat, kNested}) {
    const auto sensor = parse_ouster_metadata(text, "os1.json");
    ASSERT_TRUE(sensor) << sensor.error().message;
    EXPECT_EQ(sensor->name, "ouster-os-1-32-g");
    EXPECT_EQ(sensor->columns, 2048u);
    EXPECT_DOUBLE_EQ(sensor->beam_origin_radius_m, 0.015806);
    EXPECT_EQ(sensor->slots, 2048u);
    EXPECT_DOUBLE_EQ(sensor->range_unit_m, 0.001);
    ASSERT_EQ(sensor->rings.size(), 3u);
    EXPECT_DOUBLE_EQ(sensor->rings[0].elevation, 10.5 * kDegree);
    EXPECT_DOUBLE_EQ(sensor->rings[0].azimuth_offset, -2.5 * kDegree);
    EXPECT_EQ(sensor->fov_up, sensor->rings.front().elevation);
    EXPECT_EQ(sensor->fov_down, sensor->rings.back().elevation);
  }
}

TEST(OusterMetadata, OrdersBeamsAndPartsEqualOnes) {
  const auto sensor = parse_ouster_metadata(
      R"({"beam_altitude_angles": [-5, 1, 1, 4], "beam_azimuth_angles": [0, 1, 2, 3],
          "lidar_mode": "512x20"})",
      "odd.json");
  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_TRUE(validate(*sensor));
  EXPECT_DOUBLE_EQ(sensor->rings[0].azimuth_offset, -3 * kDegree);
  EXPECT_NEAR(sensor->rings[2].elevation, 1 * kDegree, 1e-8);
  EXPECT_LT(sensor->rings[2].elevation, sensor->rings[1].elevation);
}

TEST(OusterMetadata, SaysWhatIsWrong) {
  const auto message = [](const std::string& text, ErrorCode code) {
    const auto sensor = parse_ouster_metadata(text, "os.json");
    EXPECT_FALSE(sensor) << text;
    if (sensor) return std::string();
    EXPECT_EQ(sensor.error().code, code) << sensor.error().message;
    EXPECT_THAT(sensor.error().message, HasSubstr("os.json"));
    return sensor.error().message;
  };
  EXPECT_THAT(message("{\n \"a\": }", ErrorCode::corrupt), HasSubstr("line 2"));
  message("", ErrorCode::corrupt);
  message("[1, 2]", ErrorCode::invalid_argument);
  EXPECT_THAT(message("{}", ErrorCode::invalid_argument), HasSubstr("beam_altitude_angles"));
  EXPECT_THAT(message(R"({"beam_altitude_angles": [1], "beam_azimuth_angles": [1, 2],
                          "lidar_mode": "512x20"})",
                      ErrorCode::invalid_argument),
              HasSubstr("1 altitude angles but 2"));
  EXPECT_THAT(message(R"({"beam_altitude_angles": [1], "beam_azimuth_angles": [1],
                          "lidar_mode": "fast"})",
                      ErrorCode::invalid_argument),
              HasSubstr("lidar_mode"));
  EXPECT_THAT(message(R"({"beam_altitude_angles": ["1"], "beam_azimuth_angles": [1]})",
                      ErrorCode::invalid_argument),
              HasSubstr("numbers"));
  EXPECT_THAT(message(R"({"beam_altitude_angles": [[1, 2]], "beam_azimuth_angles": [[1, 2]]})",
                      ErrorCode::unsupported),
              HasSubstr("flash"));
  message(
      R"({"beam_altitude_angles": [1e300], "beam_azimuth_angles": [1], "lidar_mode": "512x20"})",
      ErrorCode::invalid_argument);
  message(R"({"beam_altitude_angles": [1e999], "beam_azimuth_angles": [1]})", ErrorCode::corrupt);
  message(R"({"beam_altitude_angles": [1], "beam_azimuth_angles": [1], "lidar_mode": "99999x1"})",
          ErrorCode::invalid_argument);
}

TEST(OusterMetadata, SurvivesAnyDamage) {
  test::Random random(17);
  for (int trial = 0; trial < 3000; ++trial) {
    std::string text = trial % 2 == 0 ? kFlat : kNested;
    if (trial % 3 == 0) text.resize(random.below(text.size()) + 1);
    for (std::size_t i = random.below(6); i > 0; --i) {
      text[random.below(text.size())] = static_cast<char>(random.below(256));
    }
    const auto sensor = parse_ouster_metadata(text, "damaged");
    if (sensor) {
      EXPECT_TRUE(validate(*sensor));
    } else {
      EXPECT_FALSE(sensor.error().message.empty());
    }
  }
  EXPECT_FALSE(parse_ouster_metadata(std::string(1000000, '['), "deep"));
}

}  // namespace
}  // namespace curlidar
