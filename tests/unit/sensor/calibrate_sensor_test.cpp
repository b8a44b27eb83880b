// SPDX-License-Identifier: BSD-3-Clause
// A profile from clouds whose rings nobody tells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "curlidar/calibrate.hpp"
#include "unit/sensor/lattice_scans.hpp"

namespace curlidar {
namespace {

using test::LatticeScanOptions;
using test::make_lattice_scan;
using testing::HasSubstr;

BeamModel sixteen_beams() {
  BeamModel model;
  model.slots = 1024;
  model.range_unit_m = .004;
  for (int k = 0; k < 16; ++k) model.beams.push_back({.26 - .035 * k, 0, -.02, .012, 0});
  return model;
}

Cloud scan_of(const BeamModel& model, const MotionTwist& motion = {}) {
  LatticeScanOptions options;
  options.step = 1;
  options.near_m = 8;
  options.grid_m = 0;
  options.motion = motion;
  return make_lattice_scan(model, options).cloud;
}

void expect_beams(const SensorProfile& sensor, const BeamModel& truth) {
  const auto model = beam_model_of(sensor);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->slots, truth.slots);
  EXPECT_EQ(model->range_unit_m, truth.range_unit_m);
  ASSERT_EQ(model->beams.size(), truth.beams.size());
  for (std::size_t k = 0; k < truth.beams.size(); ++k) {
    EXPECT_NEAR(model->beams[k].elevation, truth.beams[k].elevation, 1e-6) << k;
    EXPECT_NEAR(model->beams[k].height_m, truth.beams[k].height_m, 1e-5) << k;
    EXPECT_NEAR(model->beams[k].lateral_m, truth.beams[k].lateral_m, 1e-5) << k;
  }
}

TEST(CalibrateSensor, MakesAProfileOfScans) {
  const BeamModel truth = sixteen_beams();
  MotionTwist motion;
  motion.move = {-.9, .01, 0};
  motion.turn = {0, 0, .02};
  const std::vector<Cloud> clouds{scan_of(truth, motion), scan_of(truth)};
  SensorCalibrationSettings settings;
  settings.name = "mine";
  double progress = 0;
  settings.progress = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, progress);
    progress = fraction;
  };
  const auto found = calibrate_sensor(clouds, settings);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(progress, 1);
  EXPECT_EQ(found->sensor.name, "mine");
  EXPECT_THAT(found->sensor.description, HasSubstr("calibrated from 2 scans"));
  expect_beams(found->sensor, truth);
  ASSERT_EQ(found->scans.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found->scans[i].returns, clouds[i].size());
    EXPECT_GT(found->scans[i].share, .999);
    EXPECT_LT(found->scans[i].across_p95_m, 2e-5);
  }
  EXPECT_TRUE(found->scans[0].compensated);
  EXPECT_NEAR(found->scans[0].move.x, -.9, 1e-4);
  EXPECT_NEAR(found->scans[0].turn.z, .02, 1e-5);
}

TEST(CalibrateSensor, PutsRingsTogetherThatWereCut) {
  // A ring attribute that counts one beam twice, as a file in another order may.
  const BeamModel truth = sixteen_beams();
  Cloud cloud = scan_of(truth);
  std::vector<std::uint16_t> rings;
  for (const Vec3& p : cloud.positions) {
    const double distance = std::hypot(p.x, p.y) - .001;
    const double elevation = std::atan2(p.z + .02, distance);
    const auto ring = static_cast<std::uint16_t>(std::lround((.26 - elevation) / .035));
    rings.push_back(ring < 3 || (ring == 3 && p.y < 0) ? ring : ring + 1);
  }
  cloud.attributes.push_back({"ring", 1, rings});
  const auto found = calibrate_sensor(std::span(&cloud, 1));
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ring_source, RingSource::ring_attribute);
  expect_beams(found->sensor, truth);
  EXPECT_EQ(found->scans.at(0).placed, cloud.size());
}

TEST(CalibrateSensor, SaysWhyNot) {
  EXPECT_EQ(calibrate_sensor({}).error().code, ErrorCode::invalid_argument);
  const Cloud empty;
  EXPECT_EQ(calibrate_sensor(std::span(&empty, 1)).error().code, ErrorCode::invalid_argument);
  Cloud cloud = scan_of(sixteen_beams());
  test::Random random(4);
  for (Vec3& p : cloud.positions) p = rotate({0, 0, random.uniform()}, p);
  const auto none = calibrate_sensor(std::span(&cloud, 1));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::unsupported);
  EXPECT_THAT(none.error().message, HasSubstr("uniform columns"));
}

}  // namespace
}  // namespace curlidar
