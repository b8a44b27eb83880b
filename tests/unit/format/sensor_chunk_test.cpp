// SPDX-License-Identifier: BSD-3-Clause
#include "format/sensor_chunk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "base/bytes.hpp"
#include "support/chunks.hpp"

namespace curlidar {
namespace {

using test::chunk_of;
using testing::HasSubstr;

SensorProfile odd_sensor() {
  SensorProfile sensor;
  sensor.name = "m\xc3\xa9lange";
  sensor.description = "three rings, no two numbers alike";
  sensor.pattern = ScanPattern::limited_field;
  for (int i = 0; i < 3; ++i) {
    sensor.rings.push_back({0.3 - std::numbers::pi / 31 * i, -0.01 * i, 0.02 + i / 3.0, -i / 7.0});
  }
  sensor.columns = 65536;
  sensor.fov_up = 0.31;
  sensor.fov_down = -0.17;
  sensor.min_range_m = 0.1;
  sensor.max_range_m = 1.0 / 3 + 100;
  sensor.beam_origin_radius_m = 0.015806;
  return sensor;
}

TEST(SensorChunk, RoundTripsEveryField) {
  const SensorProfile sensor = odd_sensor();
  const auto payload = write_sensor(sensor);
  ASSERT_TRUE(payload) << payload.error().message;
  const auto back = read_sensor(chunk_of(ChunkType::sensor, *payload));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->name, sensor.name);
  EXPECT_EQ(back->description, sensor.description);
  EXPECT_EQ(back->pattern, sensor.pattern);
  EXPECT_EQ(back->columns, sensor.columns);
  EXPECT_EQ(back->fov_up, sensor.fov_up);
  EXPECT_EQ(back->fov_down, sensor.fov_down);
  EXPECT_EQ(back->min_range_m, sensor.min_range_m);
  EXPECT_EQ(back->max_range_m, sensor.max_range_m);
  EXPECT_EQ(back->beam_origin_radius_m, sensor.beam_origin_radius_m);
  ASSERT_EQ(back->rings.size(), sensor.rings.size());
  for (std::size_t i = 0; i < sensor.rings.size(); ++i) {
    EXPECT_EQ(back->rings[i].elevation, sensor.rings[i].elevation);
    EXPECT_EQ(back->rings[i].azimuth_offset, sensor.rings[i].azimuth_offset);
    EXPECT_EQ(back->rings[i].vertical_offset_m, sensor.rings[i].vertical_offset_m);
    EXPECT_EQ(back->rings[i].horizontal_offset_m, sensor.rings[i].horizontal_offset_m);
  }
}

TEST(SensorChunk, EveryBuiltInSensorFitsInLittle) {
  for (const std::string& name : builtin_sensor_names()) {
    const auto sensor = builtin_sensor(name);
    ASSERT_TRUE(sensor) << name;
    const auto payload = write_sensor(*sensor);
    ASSERT_TRUE(payload) << payload.error().message;
    EXPECT_LT(payload->size(), 200 + sensor->rings.size() * 4 * sizeof(double)) << name;
    EXPECT_TRUE(read_sensor(chunk_of(ChunkType::sensor, *payload))) << name;
  }
}

TEST(SensorChunk, RefusesToWriteWhatItCouldNotRead) {
  SensorProfile rings_astray = odd_sensor();
  std::swap(rings_astray.rings[0], rings_astray.rings[2]);
  EXPECT_FALSE(write_sensor(rings_astray));
  SensorProfile latin = odd_sensor();
  latin.name = "m\xe9lange";
  EXPECT_FALSE(write_sensor(latin));
  SensorProfile wordy = odd_sensor();
  wordy.description.assign(kMaxSensorDescriptionBytes + 1, 'x');
  EXPECT_FALSE(write_sensor(wordy));
}

/// Replaces the first `from` in the payload by `to`.
std::vector<std::byte> patched(std::vector<std::byte> payload, double from, double to) {
  ByteWriter before, after;
  before.write(from);
  after.write(to);
  const auto at =
      std::search(payload.begin(), payload.end(), before.bytes().begin(), before.bytes().end());
  EXPECT_NE(at, payload.end());
  std::copy(after.bytes().begin(), after.bytes().end(), at);
  return payload;
}

TEST(SensorChunk, ReadsOnlySensorsThatMakeSense) {
  const auto payload = write_sensor(odd_sensor());
  ASSERT_TRUE(payload);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double fov_up : {nan, -3.0, 1e300}) {
    const auto bytes = patched(*payload, 0.31, fov_up);
    const auto back = read_sensor(chunk_of(ChunkType::sensor, bytes));
    ASSERT_FALSE(back);
    EXPECT_EQ(back.error().code, ErrorCode::corrupt);
    EXPECT_THAT(back.error().message, HasSubstr("sensor chunk"));
  }
}

}  // namespace
}  // namespace curlidar
