// SPDX-License-Identifier: BSD-3-Clause
// Small simulated scans for tests of the whole pipeline.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <string_view>

#include "curlidar/codec.hpp"
#include "curlidar/sensor.hpp"
#include "curlidar/simulate.hpp"

namespace curlidar::test {

inline constexpr double kDegree = std::numbers::pi / 180;

/// A spinning sensor with evenly spaced rings from +10 to -20 degrees.
inline SensorProfile small_sensor(std::size_t rings = 24, std::uint32_t columns = 256) {
  SensorProfile sensor;
  sensor.name = "small";
  sensor.columns = columns;
  sensor.fov_up = 10 * kDegree;
  sensor.fov_down = -20 * kDegree;
  sensor.max_range_m = 100;
  for (std::size_t i = 0; i < rings; ++i) {
    const double share = rings > 1 ? static_cast<double>(i) / static_cast<double>(rings - 1) : 0;
    sensor.rings.push_back(
        {.elevation = sensor.fov_up + (sensor.fov_down - sensor.fov_up) * share});
  }
  return sensor;
}

/// Settings of the paper's profile that suit small_sensor's coarse grid.
inline EncodeSettings small_settings(const SensorProfile& sensor = small_sensor()) {
  EncodeSettings settings;
  settings.profile = Profile::paper;
  settings.sensor = sensor;
  settings.paper.columns = sensor.columns;
  settings.paper.min_range_m = 1;
  settings.paper.max_range = {};
  settings.paper.cliffs = {4, 1, 4.2};
  settings.paper.outlier_radius_m = 0;
  return settings;
}

inline Cloud small_scan(std::string_view scene = "street",
                        const SensorProfile& sensor = small_sensor()) {
  const auto world = make_scene(scene);
  return simulate(**world, sensor).value();
}

/// Names test cases by their profile.
inline std::string profile_test_name(const testing::TestParamInfo<Profile>& info) {
  std::string name = to_string(info.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace curlidar::test
