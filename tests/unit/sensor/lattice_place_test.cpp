// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numbers>

#include "sensor/lattice_place.hpp"

namespace curlidar {
namespace {

constexpr double kTolerance = .0015, kReach = .004;

BeamModel two_beams(std::uint32_t slots) {
  BeamModel model;
  model.slots = slots;
  model.beams.resize(2);
  return model;
}

/// A return `across_m` beside an encoder position.
Sighting beside(std::uint32_t slot, std::uint16_t ring, double position, double distance_m,
                double across_m, std::uint32_t slots, double up_m = 0) {
  const double step_m = 2 * std::numbers::pi / slots * distance_m;
  double encoder = position + across_m / step_m;
  if (encoder < 0) encoder += slots;
  return {slot, ring, encoder, up_m, distance_m, distance_m, 0};
}

TEST(LatticePlace, NumbersTheFirings) {
  const auto placement =
      place_returns({beside(0, 0, 40, 20, .0004, 4000), beside(1, 1, 40, 20, -.0004, 4000),
                     beside(2, 0, 7, 20, 0, 4000)},
                    two_beams(4000), kTolerance, kReach);
  EXPECT_EQ(placement.firings, (std::vector<std::uint32_t>{7, 40}));
  ASSERT_EQ(placement.places.size(), 3u);
  for (const auto& place : placement.places) {
    EXPECT_EQ(place.firing, place.sighting == 2 ? 0u : 1u);
    EXPECT_LE(std::abs(place.across_m), .00041);
  }
  EXPECT_EQ(placement.sharing, 0u);
}

TEST(LatticePlace, GoesRoundTheTurn) {
  const auto placement =
      place_returns({beside(0, 0, 0, 20, -.0005, 4000), beside(1, 1, 0, 20, .0005, 4000)},
                    two_beams(4000), kTolerance, kReach);
  EXPECT_EQ(placement.firings, std::vector<std::uint32_t>{0});
  EXPECT_EQ(placement.places.size(), 2u);
}

TEST(LatticePlace, NearReturnsJoinTheFiringsOfFarOnes) {
  // A step of a fine encoder is a fraction of a millimetre at 2 m, and 9 mm at 50 m.
  const auto placement =
      place_returns({beside(0, 0, 100, 2, .0011, 36000), beside(1, 1, 100, 50, .0003, 36000)},
                    two_beams(36000), kTolerance, kReach);
  EXPECT_EQ(placement.firings, std::vector<std::uint32_t>{100});
  EXPECT_EQ(placement.places.size(), 2u);
}

TEST(LatticePlace, TheFirstOfTwoAlongARayHasThePlace) {
  const auto placement =
      place_returns({beside(0, 0, 9, 20, .0001, 4000), beside(1, 0, 9, 30, 0, 4000)},
                    two_beams(4000), kTolerance, kReach);
  ASSERT_EQ(placement.places.size(), 1u);
  EXPECT_EQ(placement.places[0].sighting, 0u);
  EXPECT_EQ(placement.sharing, 1u);
}

TEST(LatticePlace, OffTheLatticeOnlyWithinReachOfAFiring) {
  const std::vector<Sighting> sightings{
      beside(0, 0, 9, 20, 0, 4000), beside(1, 1, 9, 20, .003, 4000),
      beside(2, 1, 500, 20, .003, 4000),        // no firing there, and off it
      beside(3, 1, 600, 20, 0, 4000, .003),     // off its cone: makes no firing
      beside(4, 0, 9, 20, .003, 4000, .0035)};  // farther than the reach
  const auto placement = place_returns(sightings, two_beams(4000), kTolerance, kReach);
  EXPECT_EQ(placement.firings, std::vector<std::uint32_t>{9});
  EXPECT_EQ(placement.places.size(), 2u);
  EXPECT_EQ(placement.sharing, 0u);
}

TEST(LatticePlace, AReturnSeenTwiceIsPlacedOnce) {
  const auto placement =
      place_returns({beside(0, 0, 9, 20, .001, 4000), beside(0, 1, 9, 20, 0, 4000)},
                    two_beams(4000), kTolerance, kReach);
  ASSERT_EQ(placement.places.size(), 1u);
  EXPECT_EQ(placement.places[0].sighting, 1u) << "the nearer ray";
}

TEST(LatticePlace, NothingToPlace) {
  const auto placement = place_returns({}, two_beams(4000), kTolerance, kReach);
  EXPECT_TRUE(placement.firings.empty());
  EXPECT_TRUE(placement.places.empty());
}

}  // namespace
}  // namespace curlidar
