// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <numbers>
#include <vector>

#include "curlidar/simulate.hpp"
#include "simulate/scenes.hpp"

namespace curlidar {
namespace {

constexpr double kPi = std::numbers::pi;

/// Ranges over a coarse fan of directions; 0 for the sky.
std::vector<double> fan(const Scene& scene) {
  std::vector<double> ranges;
  for (int row = 0; row < 24; ++row) {
    for (int column = 0; column < 72; ++column) {
      Hit hit;
      const bool met =
          scene.cast({}, direction_of(0.5 - 0.06 * row, kPi * column / 36 + 0.01), hit);
      ranges.push_back(met ? hit.range_m : 0);
    }
  }
  return ranges;
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, SeedFixesTheWorld) {
  const std::vector<double> a = fan(**make_scene(GetParam(), 5));
  const std::vector<double> b = fan(**make_scene(GetParam(), 5));
  const std::vector<double> c = fan(**make_scene(GetParam(), 6));
  EXPECT_EQ(a, b);
  EXPECT_NE(a, c);
}

TEST_P(EveryScene, StandsFreeOnClosedGround) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const auto scene = make_scene(GetParam(), seed);
    ASSERT_TRUE(scene);
    Hit below;
    ASSERT_TRUE((*scene)->cast({}, {0, 0, -1}, below));
    EXPECT_GT(below.range_m, 1.0);
    EXPECT_LT(below.range_m, 2.0);
    for (int column = 0; column < 3600; ++column) {
      const double azimuth = 2 * kPi * column / 3600;
      Hit hit;
      // No leak through the ground, and nothing in the sensor's face.
      ASSERT_TRUE((*scene)->cast({}, direction_of(-0.35, azimuth), hit)) << azimuth;
      ASSERT_LT(hit.range_m, 12) << azimuth;
      if ((*scene)->cast({}, direction_of(0, azimuth), hit)) {
        ASSERT_GT(hit.range_m, 0.7) << azimuth;
      }
      ASSERT_GE(hit.reflectivity, 0);
      ASSERT_LE(hit.reflectivity, 1);
    }
  }
}

TEST_P(EveryScene, HasDepthAndDetail) {
  const auto scene = make_scene(GetParam());
  double nearest = 1e9, furthest = 0;
  int jumps = 0;
  double last = 0;
  for (int column = 0; column < 2000; ++column) {
    Hit hit;
    const bool met = (*scene)->cast({}, direction_of(-0.03, 2 * kPi * column / 2000), hit);
    const double range = met ? hit.range_m : 0;
    if (met) nearest = std::min(nearest, range), furthest = std::max(furthest, range);
    jumps += std::abs(range - last) > 0.3;
    last = range;
  }
  EXPECT_GT(furthest, 1.5 * nearest);
  EXPECT_GT(jumps, 10);
}

INSTANTIATE_TEST_SUITE_P(Names, EveryScene, testing::ValuesIn(scene_names()), [](const auto& test) {
  std::string name = test.param;
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
});

/// Worlds must not depend on the compiler (order of evaluation, contraction) or the machine. The
/// figures change whenever a scene is redrawn: then take them from the message.
TEST(Scenes, SameWorldEverywhere) {
  const std::map<std::string, double> golden = {{"street", 14273.9196932},
                                                {"room", 4499.57705713},
                                                {"forest", 12585.8104452},
                                                {"corridor", 4607.69753809},
                                                {"newer-college", 19277.2928172}};
  for (const auto& [name, expected] : golden) {
    double sum = 0;
    for (const double range : fan(**make_scene(name, 7))) sum += range;
    EXPECT_NEAR(sum, expected, 1e-4) << name << ": " << std::setprecision(12) << sum;
  }
}

TEST(Scenes, SensorHeights) {
  const auto height = [](const char* name) {
    Hit hit;
    (*make_scene(name))->cast({}, {0, 0, -1}, hit);
    return hit.range_m;
  };
  EXPECT_NEAR(height("street"), 1.73, 0.01);
  EXPECT_NEAR(height("newer-college"), 1.5, 0.06);
  EXPECT_NEAR(height("forest"), 1.5, 0.1);
  EXPECT_NEAR(height("room"), 1.15, 0.02);
}

TEST(Scenes, UnknownNamesAreToldTheKnownOnes) {
  const auto scene = make_scene("moon");
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().code, ErrorCode::not_found);
  EXPECT_NE(scene.error().message.find("street"), std::string::npos);
}

}  // namespace
}  // namespace curlidar
