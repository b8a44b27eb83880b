// SPDX-License-Identifier: BSD-3-Clause
// A file of every fourth ring of a sensor, seen by the whole sensor.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "curlidar/simulate.hpp"
#include "report/measure/upsampling_files.hpp"

namespace curlidar::bench {
namespace {

/// 29 rings over most of the image's rows, on columns that do not lie on the borders of its cells.
SensorProfile sensor_of_the_image() {
  SensorProfile sensor;
  sensor.name = "of-the-image";
  sensor.columns = 250;
  for (int ring = 0; ring < 29; ++ring) {
    sensor.rings.push_back({.elevation = 0.03 - 0.015 * ring});
  }
  sensor.fov_up = 0.03;
  sensor.fov_down = sensor.rings.back().elevation;
  return sensor;
}

TEST(UpsamplingFiles, ShowTheWholeSensorsImage) {
  const SensorProfile sensor = sensor_of_the_image();
  const auto room = make_scene("room").value();
  const Cloud cloud = simulate(*room, sensor, {.range_noise_m = 0, .dropout = 0}).value();
  const Detection rings = assign_rings(cloud, sensor).value();
  const auto file = file_of_rings(cloud, rings, CompactTarget::error, 0.005);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->scan.field->lattice().rows(), 8u);  // rings 0, 4, .. 28
  EXPECT_GT(file->bits_per_point, 0);
  const auto image = seen_by(*file, sensor, nullptr);
  ASSERT_TRUE(image) << image.error().message;
  const tulip::Image truth = tulip::project(cloud);
  std::size_t there = 0, told = 0, near = 0;
  for (std::size_t i = 0; i < truth.range_m.size(); ++i) {
    there += truth.range_m[i] > 0 ? 1 : 0;
    if (!(truth.range_m[i] > 0 && image->range_m[i] > 0)) continue;
    ++told;
    near += std::abs(truth.range_m[i] - image->range_m[i]) < 0.05 ? 1 : 0;
  }
  EXPECT_GT(there, 6000u);
  EXPECT_GT(told, 0.95 * static_cast<double>(there));
  EXPECT_GT(near, 0.75 * static_cast<double>(told));
}

TEST(UpsamplingFiles, HoldNothingOfTheOtherRings) {
  const SensorProfile sensor = sensor_of_the_image();
  Cloud cloud;
  for (const Ring& ring : sensor.rings) {
    for (int column = 0; column < 20; ++column) {
      cloud.positions.push_back(direction_of(ring.elevation, 0.3 * column) * 9);
    }
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  const Detection rings = assign_rings(cloud, sensor).value();
  const auto file = file_of_rings(cloud, rings, CompactTarget::error, 0.005);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->scan.coded_returns, 8u * 20);
}

}  // namespace
}  // namespace curlidar::bench
