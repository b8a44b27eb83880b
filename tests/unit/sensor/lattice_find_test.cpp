// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "sensor/lattice.hpp"
#include "unit/sensor/lattice_scans.hpp"

namespace curlidar {
namespace {

using test::LatticeScan;
using test::LatticeScanOptions;
using test::make_lattice_scan;
using test::two_blocks;

LatticeFit find(const LatticeScan& scan, const BeamModel& model,
                const LatticeSettings& settings = {}) {
  const auto found = find_lattice(scan.cloud, scan.rings, std::vector{model}, settings);
  EXPECT_TRUE(found) << (found ? "" : found.error().message);
  if (!found || !*found) {
    ADD_FAILURE() << "no lattice";
    return {};
  }
  return **found;
}

/// Every point at its own encoder position, and the model's point where it was measured.
void expect_exact(const LatticeScan& scan, const LatticeFit& fit, double tolerance_m) {
  ASSERT_EQ(fit.firing_of_point.size(), scan.cloud.size());
  EXPECT_EQ(fit.placed, scan.cloud.size());
  EXPECT_GT(fit.share, .999);
  EXPECT_TRUE(std::is_sorted(fit.firings.begin(), fit.firings.end()));
  std::size_t wrong = 0;
  double worst = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    if (fit.firing_of_point[i] == kNoFiring) continue;
    const std::uint32_t position = fit.firings.at(fit.firing_of_point[i]);
    if (position != scan.position[i] || fit.ring_of_point[i] != scan.rings.ring_of_point[i]) {
      ++wrong;
    }
    const Vec3 p = lattice_point(fit.beams, fit.ring_of_point[i], position, fit.range_of_point[i]);
    worst = std::max(worst, norm(apply_motion(fit.motion, p) - scan.cloud.positions[i]));
  }
  EXPECT_LE(wrong, 2u);  // beams cross: a return may lie on two
  EXPECT_LT(worst, tolerance_m);
}

/// Few returns: enough where only failure is to be seen.
LatticeScanOptions sparse() {
  LatticeScanOptions options;
  options.step = 20;
  return options;
}

MotionTwist driving(double speed_m, double yaw) {
  MotionTwist motion;
  motion.turn = {.002, -.0015, yaw};
  motion.move = {-speed_m, .03, -.01};
  return motion;
}

TEST(LatticeFind, PlacesAnUncompensatedScan) {
  const BeamModel model = two_blocks();
  const LatticeScan scan = make_lattice_scan(model, {});
  const LatticeFit fit = find(scan, model);
  EXPECT_TRUE(fit.motion.none());
  EXPECT_EQ(fit.firings.size(), 2000u);
  EXPECT_LT(fit.residuals.up_median_m, .0004);
  EXPECT_LT(fit.residuals.across_p95_m, .0007);
  EXPECT_LT(fit.residuals.range_median_m, .0004);
  expect_exact(scan, fit, .0012);
  EXPECT_EQ(fit.notes.size(), 1u);
}

TEST(LatticeFind, UndoesMotionOfAnySpeed) {
  const BeamModel model = two_blocks();
  for (const MotionTwist& motion : {driving(.02, .0005), driving(.8, -.002), driving(1.5, .03),
                                    driving(3, -.1), driving(-.5, .3)}) {
    LatticeScanOptions options;
    options.motion = motion;
    options.step = 5;
    const LatticeScan scan = make_lattice_scan(model, options);
    const LatticeFit fit = find(scan, model);
    EXPECT_NEAR(fit.motion.turn.z, motion.turn.z, 1e-5);
    EXPECT_NEAR(norm(fit.motion.turn - motion.turn), 0, 2e-5);
    EXPECT_NEAR(norm(fit.motion.move - motion.move), 0, 2e-4);
    expect_exact(scan, fit, .0013);
    EXPECT_GE(fit.notes.size(), 2u);
  }
}

TEST(LatticeFind, UndoesUnevenMotionInAnotherFrame) {
  const BeamModel model = two_blocks(32);
  for (const double yaw : {.003, -.02}) {
    LatticeScanOptions options;
    options.step = 6;
    options.motion = driving(.9, .02);
    options.motion.turn2 = {.0004, -.0008, yaw};
    options.motion.move2 = {.05, -.01, .004};
    options.motion.rigid_turn = {.01, -.006, 0};
    options.motion.rigid_move = {.02, -.03, .05};
    const LatticeScan scan = make_lattice_scan(model, options);
    expect_exact(scan, find(scan, model), .0016);
  }
}

TEST(LatticeFind, PlacesColumnsOfAFineEncoder) {
  BeamModel model = two_blocks(16, 36000);
  for (Beam& beam : model.beams) beam.azimuth_offset = beam.lateral_m = beam.height_m = 0;
  LatticeScanOptions options;
  options.step = 17;
  options.grid_m = 0;
  const LatticeScan scan = make_lattice_scan(model, options);
  const LatticeFit fit = find(scan, model);
  EXPECT_EQ(fit.firings.size(), (36000u + 16) / 17);
  expect_exact(scan, fit, 1e-4);
  // Rounded to millimetres near returns know their position from the far ones of their column.
  options.grid_m = .001;
  const LatticeScan coarse = make_lattice_scan(model, options);
  expect_exact(coarse, find(coarse, model), .0016);
}

TEST(LatticeFind, CorrectsRingsThatWereMislabelled) {
  const BeamModel model = two_blocks();
  LatticeScanOptions options;
  options.motion = driving(1, .01);
  LatticeScan scan = make_lattice_scan(model, options);
  const std::vector<std::uint16_t> truth = scan.rings.ring_of_point;
  // A stretch of one ring that went to the next, and points without a ring.
  for (std::size_t i = 5000; i < 5400; ++i) ++scan.rings.ring_of_point[i];
  for (std::size_t i = 9000; i < 9050; ++i) scan.rings.ring_of_point[i] = kNoRing;
  const LatticeFit fit = find(scan, model);
  scan.rings.ring_of_point = truth;
  expect_exact(scan, fit, .0013);
}

TEST(LatticeFind, LeavesReturnsOffTheLatticeLoose) {
  const BeamModel model = two_blocks();
  LatticeScan scan = make_lattice_scan(model, {});
  const std::size_t regular = scan.cloud.size();
  const auto add = [&](const Vec3& p, std::uint16_t ring) {
    scan.cloud.positions.push_back(p);
    scan.rings.ring_of_point.push_back(ring);
  };
  add(scan.cloud.positions[0], scan.rings.ring_of_point[0]);  // a duplicate
  add({0, 0, 0}, kNoRing);                                    // no return
  add({std::numeric_limits<double>::quiet_NaN(), 0, 0}, kNoRing);
  add({.001, 0, 0}, 3);  // inside the beams' origins
  add({1, 2, 40}, 0);    // where no beam looks
  add({1e30, 1e30, 0}, 0);
  add({1e200, -1e200, 1e200}, 2);
  add({std::numeric_limits<double>::max(), 0, 0}, 1);
  const LatticeFit fit = find(scan, model);
  EXPECT_EQ(fit.returns, regular + 6);
  EXPECT_EQ(fit.placed, regular);
  EXPECT_EQ(fit.sharing, 1u);
  EXPECT_NE(fit.firing_of_point[0], kNoFiring) << "the first of two has the place";
  for (std::size_t i = regular + 1; i < scan.cloud.size(); ++i) {
    EXPECT_EQ(fit.firing_of_point[i], kNoFiring) << i;
  }
}

TEST(LatticeFind, PicksTheModelThatFits) {
  const BeamModel model = two_blocks();
  LatticeScanOptions options;
  options.motion = driving(.7, .004);
  const LatticeScan scan = make_lattice_scan(model, options);
  BeamModel other = model, few = two_blocks(8);
  other.table = "other";
  for (std::size_t k = 0; k < other.beams.size(); ++k) {
    other.beams[k].elevation += k % 2 == 0 ? .0005 : -.0005;
  }
  const auto found = find_lattice(scan.cloud, scan.rings, std::vector{few, other, model});
  ASSERT_TRUE(found && *found);
  EXPECT_EQ((*found)->beams, model);
  const auto none = find_lattice(scan.cloud, scan.rings, std::vector{few, other});
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST(LatticeFind, RefusesALatticeWithHardlyAReturnInAFiring) {
  // Each ring at encoder positions of its own.
  const BeamModel model = two_blocks(16, 36000);
  BeamModel shifted = model;
  for (std::size_t k = 0; k < 16; ++k) {
    shifted.beams[k].azimuth_offset += static_cast<double>(k) * 2 * std::numbers::pi / 36000;
  }
  LatticeScanOptions options;
  options.step = 18;
  options.near_m = 20;
  const LatticeScan scan = make_lattice_scan(shifted, options);
  const auto none = find_lattice(scan.cloud, scan.rings, std::vector{model});
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
  EXPECT_EQ(find(scan, shifted).placed, scan.cloud.size());
}

TEST(LatticeFind, FindsNoneInPointsAtRandom) {
  const BeamModel model = two_blocks();
  LatticeScan scan = make_lattice_scan(model, sparse());
  test::Random random(8);
  for (Vec3& p : scan.cloud.positions) {
    p = {40 * random.normal(), 40 * random.normal(), random.normal()};
  }
  const auto none = find_lattice(scan.cloud, scan.rings, std::vector{model});
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST(LatticeFind, IsCalmAboutReturnsThatSayNothing) {
  // One point over and over; a line; points on the axis; points far beyond any range.
  const BeamModel model = two_blocks();
  for (int kind = 0; kind < 4; ++kind) {
    LatticeScan scan = make_lattice_scan(model, sparse());
    double along = 0;
    for (Vec3& p : scan.cloud.positions) {
      along += .001;
      p = kind == 0   ? Vec3{4, 5, -1}
          : kind == 1 ? Vec3{along, 2, 0}
          : kind == 2 ? Vec3{0, 0, along}
                      : Vec3{1e7 + along, -1e150, 1e300};
    }
    const auto found = find_lattice(scan.cloud, scan.rings, std::vector{model});
    ASSERT_TRUE(found);
    EXPECT_FALSE(*found) << kind;
  }
}

TEST(LatticeFind, IsCalmAboutEmptyAndMismatchedInput) {
  const BeamModel model = two_blocks();
  const auto empty = find_lattice({}, {}, std::vector{model});
  ASSERT_TRUE(empty);
  EXPECT_FALSE(*empty);
  Cloud cloud;
  cloud.positions = {{1, 2, 3}};
  const auto wrong = find_lattice(cloud, {}, std::vector{model});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::invalid_argument);
}

TEST(LatticeFind, IsDeterministic) {
  const BeamModel model = two_blocks();
  LatticeScanOptions options;
  options.motion = driving(.7, .004);
  const LatticeScan scan = make_lattice_scan(model, options);
  const LatticeFit a = find(scan, model), b = find(scan, model);
  EXPECT_EQ(a.motion, b.motion);
  EXPECT_EQ(a.firings, b.firings);
  EXPECT_EQ(a.firing_of_point, b.firing_of_point);
  EXPECT_EQ(a.range_of_point, b.range_of_point);
}

TEST(LatticeRays, ViewsInvertPoints) {
  const BeamModel model = two_blocks();
  for (std::size_t k = 0; k < model.beams.size(); ++k) {
    const Vec3 p = lattice_point(model, k, 321, 12.5);
    const auto view = view_along(model.beams[k], p);
    ASSERT_TRUE(view);
    EXPECT_NEAR(view->range, 12.5, 1e-12);
    EXPECT_NEAR(view->up_m, 0, 1e-12);
    EXPECT_NEAR(view->encoder, -std::numbers::pi + 2 * std::numbers::pi * 321 / 4000, 1e-12);
  }
  EXPECT_FALSE(view_along(model.beams[0], {.01, .01, 3}));
}

TEST(LatticeRays, OustersBeamOriginsBecomeOffsets) {
  SensorProfile profile;
  profile.slots = 1024;
  profile.beam_origin_radius_m = .0277;
  for (const double e : {.3, -.1}) {
    Ring ring;
    ring.elevation = e;
    ring.azimuth_offset = .05;
    profile.rings.push_back(ring);
  }
  const auto model = beam_model_of(profile);
  ASSERT_TRUE(model);
  // Ouster's own formula: a range counts from the axis, the beam starts beside it.
  const double range = 17.25, n = profile.beam_origin_radius_m;
  const double encoder = -std::numbers::pi + 2 * std::numbers::pi * 100 / 1024;
  const Vec3 expected = direction_of(.3, encoder + .05) * (range - n) +
                        Vec3{n * std::cos(encoder), n * std::sin(encoder), 0};
  EXPECT_NEAR(norm(lattice_point(*model, 0, 100, range) - expected), 0, 1e-12);
  profile.slots = 0;
  EXPECT_FALSE(beam_model_of(profile));
}

}  // namespace
}  // namespace curlidar
