// SPDX-License-Identifier: BSD-3-Clause
// Directions that somebody else chose, and virtual sensors.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/scene_field.hpp"

namespace curlidar {
namespace {

using test::BoxScene;

DecodedScan box(bool screen = false) {
  return test::exact_scan(std::make_shared<BoxScene>(screen), test::small_sensor());
}

/// Its field is asked as it is: it tells confidences.
ReconstructSettings exact_field() {
  ReconstructSettings settings;
  settings.field = box().field;
  return settings;
}

std::vector<Vec3> some_directions() {
  std::vector<Vec3> directions;
  for (int i = 0; i < 2000; ++i) {
    const double azimuth = 0.37 * i, elevation = 0.02 * (i % 40) - 0.5;
    directions.push_back(direction_of(elevation, azimuth) * (0.5 + i % 7));
  }
  return directions;
}

TEST(ReconstructDirections, GivesOnePointForEachInTheirOrderAndNanWhereNothingIsKnown) {
  const std::vector<Vec3> directions = some_directions();
  ReconstructSettings settings = exact_field();
  settings.confidence = true;
  const Cloud cloud = reconstruct_directions(box(), directions, settings).value();
  ASSERT_EQ(cloud.size(), directions.size());
  EXPECT_EQ(cloud.width, directions.size());
  const BoxScene scene;
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Vec3 d = directions[i] * (1 / norm(directions[i]));
    if (!is_return(cloud.positions[i])) {
      ++unknown;
      EXPECT_TRUE(std::isnan(cloud.positions[i].z));
      EXPECT_TRUE(elevation_of(d) > 0.18 || elevation_of(d) < -0.355);
      continue;
    }
    Hit hit;
    scene.cast({}, d, hit);
    ASSERT_LT(norm(cloud.positions[i] - d * hit.range_m), 1e-9) << i;
    ASSERT_EQ(cloud.find("confidence")->as_double(i), d.x > 0 ? 0.9F : 0.3F);
  }
  EXPECT_GT(unknown, 500u);
  EXPECT_LT(unknown, 1500u);
}

TEST(ReconstructDirections, NamesTheDirectionThatIsNone) {
  std::vector<Vec3> directions = some_directions();
  for (const Vec3 bad :
       {Vec3{}, Vec3{std::nan(""), 0, 1}, Vec3{std::numeric_limits<double>::infinity(), 0, 0}}) {
    directions[1234] = bad;
    const auto refused = reconstruct_directions(box(), directions);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
    EXPECT_NE(refused.error().message.find("1234"), std::string::npos);
  }
  EXPECT_EQ(reconstruct_directions(box(), {})->size(), 0u);
}

TEST(ReconstructDirections, LeastConfidenceAndRegionLeaveTheirSlotsEmpty) {
  const std::vector<Vec3> directions = some_directions();
  ReconstructSettings settings = exact_field();
  settings.min_confidence = 0.5;
  const Cloud sure = reconstruct_directions(box(), directions, settings).value();
  for (const Vec3& p : sure.positions) {
    ASSERT_TRUE(std::isnan(p.x) || p.x > 0);
  }
  settings.min_confidence = 0;
  settings.region = ScanRegion{.azimuth_begin = 3, .azimuth_end = 4};  // across the seam
  const Cloud part = reconstruct_directions(box(), directions, settings).value();
  EXPECT_GT(count_returns(part), 100u);
  for (const Vec3& p : part.positions) {
    if (!is_return(p)) continue;
    const double azimuth = azimuth_of(p) < 0 ? azimuth_of(p) + 2 * std::numbers::pi : azimuth_of(p);
    ASSERT_TRUE(azimuth >= 3 && azimuth < 4) << azimuth;
  }
  settings.min_confidence = 1.5;
  EXPECT_EQ(reconstruct_directions(box(), directions, settings).error().code,
            ErrorCode::invalid_argument);
}

/// Beams that start beside the origin, at heights of their own.
SensorProfile odd_sensor() {
  SensorProfile sensor = test::small_sensor(9, 180);
  sensor.beam_origin_radius_m = 0.03;
  for (std::size_t i = 0; i < sensor.rings.size(); ++i) {
    sensor.rings[i].elevation *= 0.8;
    sensor.rings[i].azimuth_offset = 0.01 * static_cast<double>(i);
    sensor.rings[i].vertical_offset_m = 0.1 - 0.02 * static_cast<double>(i);
    sensor.rings[i].horizontal_offset_m = 0.02;
  }
  sensor.max_range_m = 7;
  return sensor;
}

TEST(ReconstructSensor, SeesWhatTheSimulatedSensorSees) {
  const SensorProfile sensor = odd_sensor();
  SimulateSettings how;
  how.range_noise_m = how.dropout = 0;
  how.beam_origins = true;
  const Cloud truth = simulate(BoxScene(), sensor, how).value();
  const Cloud seen = reconstruct_sensor(box(), sensor).value();
  ASSERT_EQ(seen.size(), truth.size());
  EXPECT_LT(seen.size(), 9u * 180u);  // the far corners are out of range
  for (std::size_t i = 0; i < seen.size(); ++i) {
    ASSERT_LT(norm(seen.positions[i] - truth.positions[i]), 1e-5) << i;  // truth is float32
    ASSERT_EQ(seen.find("ring")->as_double(i), truth.find("ring")->as_double(i));
  }
}

TEST(ReconstructSensor, OrganisedKeepsRingsAndColumns) {
  const Cloud seen = reconstruct_sensor(box(), odd_sensor(), {.organised = true}).value();
  EXPECT_EQ(seen.height, 9u);
  EXPECT_EQ(seen.width, 180u);
  EXPECT_EQ(seen.size(), 9u * 180u);
  EXPECT_EQ(count_returns(seen), reconstruct_sensor(box(), odd_sensor())->size());
}

TEST(ReconstructSensor, RefusesWhatDoesNotTurn) {
  SensorProfile sensor = odd_sensor();
  sensor.pattern = ScanPattern::limited_field;
  EXPECT_EQ(reconstruct_sensor(box(), sensor).error().code, ErrorCode::unsupported);
  EXPECT_EQ(reconstruct_sensor(box(), SensorProfile{}).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(reconstruct_sensor(box(), odd_sensor(), {.max_points = 100}).error().code,
            ErrorCode::limit_exceeded);
  EXPECT_EQ(reconstruct_sensor(box(), odd_sensor(), {.keep_originals = true}).error().code,
            ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace curlidar
