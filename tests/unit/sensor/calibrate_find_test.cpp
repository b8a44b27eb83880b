// SPDX-License-Identifier: BSD-3-Clause
// Beams found again in scans computed from beams that are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sensor/calibrate.hpp"
#include "unit/sensor/lattice_scans.hpp"

namespace curlidar {
namespace {

using test::LatticeScan;
using test::LatticeScanOptions;
using test::make_lattice_scan;
using test::two_blocks;

/// Whether lasers fire at an encoder position: at two of five, in no regular order.
bool fires(std::uint32_t position) {
  std::uint32_t hash = position * 2654435761u;
  hash = (hash ^ hash >> 15) * 2246822519u;
  return (hash ^ hash >> 13) % 5 < 2;
}

/// Firings of a turn of 4000 positions.
std::size_t firings_of_turn() {
  std::size_t count = 0;
  for (std::uint32_t position = 0; position < 4000; ++position) count += fires(position) ? 1 : 0;
  return count;
}

/// The returns at positions where lasers fire.
LatticeScan fired(const LatticeScan& scan) {
  LatticeScan out = scan;
  out.cloud.positions.clear();
  out.rings.ring_of_point.clear();
  out.position.clear();
  out.range.clear();
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    if (!fires(scan.position[i])) continue;
    out.cloud.positions.push_back(scan.cloud.positions[i]);
    out.rings.ring_of_point.push_back(scan.rings.ring_of_point[i]);
    out.position.push_back(scan.position[i]);
    out.range.push_back(scan.range[i]);
  }
  return out;
}

/// A scan of a sensor whose elevations are known about right, and nothing else.
LatticeScan unknown(const BeamModel& model, const LatticeScanOptions& options) {
  LatticeScan scan = make_lattice_scan(model, options);
  if (options.step == 1) scan = fired(scan);
  scan.rings.source = RingSource::azimuth_wraps;
  for (std::size_t k = 0; k < model.beams.size(); ++k) {
    // What the origin sees, far out.
    scan.rings.sensor.rings[k].elevation = model.beams[k].elevation + model.beams[k].height_m / 30;
  }
  return scan;
}

Calibration found(const std::vector<LatticeScan>& scans, std::size_t threads = 1) {
  std::vector<RingedScan> ringed;
  for (const LatticeScan& scan : scans) ringed.push_back({&scan.cloud, &scan.rings});
  CalibrateSettings settings;
  settings.threads = threads;
  const auto calibration = calibrate(ringed, settings);
  EXPECT_TRUE(calibration) << (calibration ? "" : calibration.error().message);
  if (!calibration || !*calibration) {
    ADD_FAILURE() << "no lattice";
    return {};
  }
  return **calibration;
}

/// Every return goes back to its place, and returns of one firing share it.
void expect_placed(const LatticeScan& scan, const BeamModel& model, std::size_t firings) {
  const auto fit = find_lattice(scan.cloud, scan.rings, std::vector{model});
  ASSERT_TRUE(fit && *fit);
  EXPECT_GT((*fit)->share, .999);
  EXPECT_GE((*fit)->placed + 2, scan.cloud.size());
  EXPECT_EQ((*fit)->firings.size(), firings);
}

void expect_beams(const BeamModel& model, const BeamModel& truth, double length_m, double angle) {
  EXPECT_EQ(model.slots, truth.slots);
  EXPECT_DOUBLE_EQ(model.range_unit_m, truth.range_unit_m);
  ASSERT_EQ(model.beams.size(), truth.beams.size());
  const double zero = model.beams[0].azimuth_offset - truth.beams[0].azimuth_offset;
  for (std::size_t k = 0; k < truth.beams.size(); ++k) {
    const Beam &is = model.beams[k], &was = truth.beams[k];
    EXPECT_NEAR(is.elevation, was.elevation, angle) << k;
    EXPECT_NEAR(is.height_m, was.height_m, length_m) << k;
    EXPECT_NEAR(is.lateral_m, was.lateral_m, length_m) << k;
    EXPECT_NEAR(std::remainder(is.range_phase_m - was.range_phase_m, truth.range_unit_m), 0,
                length_m)
        << k;
    EXPECT_NEAR(is.azimuth_offset - was.azimuth_offset, zero, angle) << k;
  }
}

TEST(Calibrate, FindsEveryBeamOfAScan) {
  const BeamModel truth = two_blocks();
  LatticeScanOptions options;
  options.step = 1;
  options.far_m = 30;
  const LatticeScan scan = unknown(truth, options);
  const Calibration calibration = found({scan});
  expect_beams(calibration.model, truth, 2e-4, 3e-5);
  EXPECT_TRUE(calibration.motions.at(0).none());
  EXPECT_LT(calibration.up_median_m, .0003);
  EXPECT_LT(calibration.across_median_m, .0003);
  EXPECT_GT(calibration.range_resultant, .6);
  expect_placed(scan, calibration.model, firings_of_turn());
}

TEST(Calibrate, FindsBeamsAndMotionTogether) {
  const BeamModel truth = two_blocks(24);
  for (const auto& [speed, yaw] : {std::pair{1.2, .03}, std::pair{2.5, -.11}}) {
    LatticeScanOptions options;
    options.step = 1;
    options.motion.turn = {.002, -.0015, yaw};
    options.motion.move = {-speed, .03, -.01};
    LatticeScan scan = unknown(truth, options);
    // 4096 positions would fit a very different yaw as well.
    if (std::abs(yaw) > .07) scan.rings.sensor.slots = 4000;
    const Calibration calibration = found({scan});
    EXPECT_NEAR(norm(calibration.motions.at(0).turn - options.motion.turn), 0, 3e-5);
    EXPECT_NEAR(norm(calibration.motions.at(0).move - options.motion.move), 0, 5e-4);
    expect_beams(calibration.model, truth, 3e-4, 5e-5);
    expect_placed(scan, calibration.model, firings_of_turn());
  }
}

TEST(Calibrate, ScansOfABatchShareTheirBeams) {
  const BeamModel truth = two_blocks();
  std::vector<LatticeScan> scans;
  for (const double speed : {0.4, 0.9, 0.0}) {
    LatticeScanOptions options;
    options.step = 1;
    options.motion.turn = {.001, .0005, .01 * speed};
    options.motion.move = {-speed, .02, 0};
    scans.push_back(unknown(truth, options));
  }
  const Calibration calibration = found(scans);
  expect_beams(calibration.model, truth, 2e-4, 3e-5);
  ASSERT_EQ(calibration.motions.size(), 3u);
  EXPECT_NEAR(calibration.motions[1].move.x, -.9, 5e-4);
  EXPECT_NEAR(calibration.motions[2].move.x, 0, 5e-4);
  EXPECT_NEAR(calibration.motions[1].turn.z, .009, 3e-5);
  for (const LatticeScan& scan : scans) expect_placed(scan, calibration.model, firings_of_turn());
  EXPECT_EQ(found(scans, 3).model, calibration.model);
}

TEST(Calibrate, FindsAFineEncoder) {
  BeamModel truth = two_blocks(8, 36000);
  for (Beam& beam : truth.beams) {
    beam.azimuth_offset = beam.lateral_m = beam.height_m = beam.range_phase_m = 0;
  }
  LatticeScanOptions options;
  options.step = 17;
  options.grid_m = 0;
  const LatticeScan scan = unknown(truth, options);
  const Calibration calibration = found({scan});
  expect_beams(calibration.model, truth, 5e-6, 1e-6);
  expect_placed(scan, calibration.model, (36000u + 16) / 17);
}

TEST(Calibrate, TakesColumnsOfAnOrganisedCloudForFirings) {
  // As an Ouster: clockwise columns, origins beside the axis, and rays that lead or lag by more
  // than a column, which only the columns can tell as all positions fire.
  SensorProfile ouster;
  ouster.slots = ouster.columns = 512;
  ouster.range_unit_m = .001;
  ouster.beam_origin_radius_m = .0277;
  for (int k = 0; k < 8; ++k) ouster.rings.push_back({.3 - .08 * k, .05 * (k % 4) - .07});
  const BeamModel truth = *beam_model_of(ouster);
  LatticeScanOptions options;
  options.step = 1;
  options.grid_m = 0;
  options.near_m = 1;
  LatticeScan scan = make_lattice_scan(truth, options);
  scan.rings.source = RingSource::organised_rows;
  Cloud organised;
  organised.width = 512;
  organised.height = 8;
  organised.positions.assign(512 * 8, {});
  std::vector<std::uint16_t> rings(512 * 8, kNoRing);
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    const std::size_t ring = scan.rings.ring_of_point[i];
    const std::size_t slot = ring * 512 + (512 - scan.position[i]) % 512;
    organised.positions[slot] = scan.cloud.positions[i];
    rings[slot] = static_cast<std::uint16_t>(ring);
  }
  scan.cloud = organised;
  scan.rings.ring_of_point = rings;
  const Calibration calibration = found({scan});
  expect_beams(calibration.model, truth, 1e-5, 1e-6);
  const auto fit = find_lattice(scan.cloud, scan.rings, std::vector{calibration.model});
  ASSERT_TRUE(fit && *fit);
  EXPECT_EQ((*fit)->placed, (*fit)->returns);
  EXPECT_EQ((*fit)->firings.size(), 512u);
  // All returns of a column are one firing.
  std::vector<std::uint32_t> firing(512, kNoFiring);
  for (std::size_t slot = 0; slot < organised.size(); ++slot) {
    if (rings[slot] == kNoRing) continue;
    std::uint32_t& of_column = firing[slot % 512];
    if (of_column == kNoFiring) of_column = (*fit)->firing_of_point[slot];
    EXPECT_EQ((*fit)->firing_of_point[slot], of_column);
  }
}

TEST(Calibrate, TakesAnOddNumberOfPositionsFromTheProfile) {
  BeamModel truth = two_blocks(8, 2083);
  for (Beam& beam : truth.beams) beam.azimuth_offset *= 2e-3;
  LatticeScanOptions options;
  options.step = 1;
  LatticeScan scan = make_lattice_scan(truth, options);
  scan.rings.source = RingSource::clustered;
  scan.rings.sensor.columns = 2083;
  const Calibration calibration = found({scan});
  expect_beams(calibration.model, truth, 2e-4, 3e-5);
  EXPECT_NEAR(calibration.model.beams[0].azimuth_offset, truth.beams[0].azimuth_offset, 3e-5);
  expect_placed(scan, calibration.model, 2083);
}

TEST(Calibrate, OutliersChangeNothing) {
  const BeamModel truth = two_blocks();
  LatticeScanOptions options;
  options.step = 1;
  LatticeScan scan = unknown(truth, options);
  const BeamModel clean = found({scan}).model;
  for (const double far : {1e5, 1e30, 1e300}) {
    scan.cloud.positions.push_back({far, -far, far / 3});
    scan.rings.ring_of_point.push_back(4);
  }
  EXPECT_EQ(found({scan}).model, clean);
  // A tenth of the returns from anywhere else.
  test::Random random(2);
  for (std::size_t i = 0; i < scan.cloud.size(); i += 10) {
    scan.cloud.positions[i] = {random.normal() * 9, random.normal() * 9, random.normal()};
  }
  const BeamModel noisy = found({scan}).model;
  EXPECT_EQ(noisy.slots, truth.slots);
  EXPECT_EQ(noisy.range_unit_m, truth.range_unit_m);
  for (std::size_t k = 0; k < truth.beams.size(); ++k) {
    EXPECT_NEAR(noisy.beams[k].elevation, truth.beams[k].elevation, 5e-5) << k;
    EXPECT_NEAR(noisy.beams[k].lateral_m, truth.beams[k].lateral_m, 5e-4) << k;
  }
}

TEST(Calibrate, KeepsBeamsWithoutReturns) {
  const BeamModel truth = two_blocks();
  LatticeScan scan = unknown(truth, {});
  for (std::uint16_t& ring : scan.rings.ring_of_point) {
    if (ring == 5) ring = kNoRing;
  }
  const Calibration calibration = found({scan});
  ASSERT_EQ(calibration.model.beams.size(), 16u);
  EXPECT_NEAR(calibration.model.beams[5].elevation, scan.rings.sensor.rings[5].elevation, 1e-7);
  EXPECT_NEAR(calibration.model.beams[6].elevation, truth.beams[6].elevation, 5e-5);
}

TEST(Calibrate, FindsNothingWhereThereIsNoLattice) {
  // Returns on cones, at azimuths of no encoder.
  test::Random random(9);
  LatticeScan scan = unknown(two_blocks(), {});
  for (Vec3& p : scan.cloud.positions) {
    const double turn = random.uniform();
    p = rotate({0, 0, turn}, p);
  }
  const RingedScan ringed{&scan.cloud, &scan.rings};
  const auto azimuths = calibrate(std::span(&ringed, 1));
  ASSERT_TRUE(azimuths);
  EXPECT_FALSE(*azimuths);
  // No cones at all.
  for (Vec3& p : scan.cloud.positions) p.z += random.uniform();
  const auto cones = calibrate(std::span(&ringed, 1));
  ASSERT_TRUE(cones);
  EXPECT_FALSE(*cones);
  // Rows that a detection made up.
  scan = unknown(two_blocks(), {});
  scan.rings.source = RingSource::uniform;
  EXPECT_FALSE(*calibrate(std::span(&ringed, 1)));
}

TEST(Calibrate, RefusesScansThatDoNotBelongTogether) {
  EXPECT_EQ(calibrate({}).error().code, ErrorCode::invalid_argument);
  const LatticeScan many = unknown(two_blocks(16), {}), few = unknown(two_blocks(8), {});
  const std::vector<RingedScan> mixed{{&many.cloud, &many.rings}, {&few.cloud, &few.rings}};
  EXPECT_THAT(calibrate(mixed).error().message, testing::HasSubstr("scan 1 has 8 rings"));
  const std::vector<RingedScan> crossed{{&many.cloud, &few.rings}};
  EXPECT_EQ(calibrate(crossed).error().code, ErrorCode::invalid_argument);
}

TEST(Calibrate, FewReturnsAreNoReason) {
  Cloud cloud;
  cloud.positions = {{1, 2, 3}, {4, 5, 6}};
  cloud.width = 2;
  Detection rings;
  rings.source = RingSource::clustered;
  rings.sensor.rings = {{.5}, {.1}};
  rings.ring_of_point = {0, 1};
  const RingedScan scan{&cloud, &rings};
  const auto calibration = calibrate(std::span(&scan, 1));
  ASSERT_TRUE(calibration);
  EXPECT_FALSE(*calibration);
}

TEST(ProfileOf, HoldsTheModel) {
  const BeamModel model = two_blocks();
  SensorProfile nominal = *builtin_sensor("vlp16");
  const auto profile = profile_of(model, nominal, "mine");
  ASSERT_TRUE(profile) << profile.error().message;
  EXPECT_EQ(profile->name, "mine");
  EXPECT_EQ(profile->max_range_m, nominal.max_range_m);
  EXPECT_EQ(beam_model_of(*profile), model);
  const auto read = parse_sensor_toml(sensor_to_toml(*profile), "mine.toml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(beam_model_of(*read), model);
  BeamModel crossed = model;
  std::swap(crossed.beams[3], crossed.beams[4]);
  EXPECT_EQ(profile_of(crossed, nominal, "mine").error().code, ErrorCode::unsupported);
}

}  // namespace
}  // namespace curlidar
