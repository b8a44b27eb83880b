// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace curlidar {
namespace {

constexpr double kPi = std::numbers::pi;

/// A ball of radius 10 around the sensor; nothing above an elevation, if asked.
class Ball final : public Scene {
 public:
  explicit Ball(double radius = 10, double top = 2) : radius_(radius), top_(top) {}
  bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const override {
    if (elevation_of(direction) > top_) return false;
    const double b = dot(origin, direction);
    hit = {-b + std::sqrt(b * b - dot(origin, origin) + radius_ * radius_), 0.5, 0.8};
    return true;
  }

 private:
  double radius_, top_;
};

SensorProfile sensor(int rings = 8, std::uint32_t columns = 512) {
  SensorProfile profile;
  profile.name = "test";
  profile.columns = columns;
  profile.fov_up = 0.1;
  profile.fov_down = -0.4;
  profile.min_range_m = 0.5;
  profile.max_range_m = 100;
  for (int i = 0; i < rings; ++i) {
    profile.rings.push_back({profile.fov_up - 0.5 * i / (rings - 1), 0, 0, 0});
  }
  return profile;
}

SimulateSettings exact() {
  SimulateSettings settings;
  settings.range_noise_m = 0;
  settings.dropout = 0;
  return settings;
}

TEST(Simulate, BeamsLookWhereTheProfileSays) {
  SensorProfile profile = sensor(3, 16);
  profile.rings[1].azimuth_offset = 0.05;
  const auto cloud = simulate(Ball(), profile, exact());
  ASSERT_TRUE(cloud);
  ASSERT_EQ(cloud->size(), 48u);
  EXPECT_FALSE(cloud->organised());
  EXPECT_EQ(cloud->width, 48u);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const Ring& ring = profile.rings[i / 16];
    const double azimuth = -kPi + 2 * kPi * static_cast<double>(i % 16) / 16 + ring.azimuth_offset;
    const Vec3 expected = direction_of(ring.elevation, azimuth) * 10;
    EXPECT_NEAR(norm(cloud->positions[i] - expected), 0, 2e-6);
    EXPECT_EQ(cloud->find("ring")->as_double(i), static_cast<double>(i / 16));
    EXPECT_NEAR(cloud->find("time")->as_double(i), 0.1 * static_cast<double>(i % 16) / 16, 1e-8);
    EXPECT_NEAR(cloud->find("intensity")->as_double(i), 0.4, 1e-7);
  }
}

TEST(Simulate, CoordinatesAreFloatsAsInAFile) {
  const auto cloud = simulate(Ball(), sensor());
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->position_type, ScalarType::float32);
  for (const Vec3& p : cloud->positions) {
    ASSERT_EQ(p.x, static_cast<double>(static_cast<float>(p.x)));
    ASSERT_EQ(p.z, static_cast<double>(static_cast<float>(p.z)));
  }
}

TEST(Simulate, BeamOriginsAreUsedOnlyWhenAsked) {
  SensorProfile profile = sensor(1, 8);
  profile.rings[0] = {0, 0.2, 0.3, 0.1};
  profile.beam_origin_radius_m = 0.05;
  SimulateSettings settings = exact();
  const auto plain = simulate(Ball(), profile, settings);
  settings.beam_origins = true;
  const auto offset = simulate(Ball(), profile, settings);
  ASSERT_TRUE(plain && offset);
  ASSERT_EQ(offset->size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(plain->positions[i].z, 0, 1e-9);
    EXPECT_NEAR(offset->positions[i].z, 0.3, 1e-6);
    EXPECT_NEAR(norm(offset->positions[i]), 10, 2e-6);  // still on the ball
    const double encoder = -kPi + 2 * kPi * static_cast<double>(i) / 8;
    const double beam = encoder + 0.2;
    const Vec3 origin{0.05 * std::cos(encoder) - 0.1 * std::sin(beam),
                      0.05 * std::sin(encoder) + 0.1 * std::cos(beam), 0.3};
    const Vec3 along = offset->positions[i] - origin;
    EXPECT_NEAR(norm(cross(along, direction_of(0, beam))), 0, 1e-5);
    EXPECT_GT(dot(along, direction_of(0, beam)), 0);
  }
}

TEST(Simulate, NoiseHasTheAskedSpreadAndNoBias) {
  SimulateSettings settings = exact();
  settings.range_noise_m = 0.03;
  const auto cloud = simulate(Ball(), sensor(16, 2048), settings);
  ASSERT_TRUE(cloud);
  double sum = 0, sum2 = 0;
  for (const Vec3& p : cloud->positions) {
    const double error = norm(p) - 10;
    sum += error;
    sum2 += error * error;
  }
  const auto n = static_cast<double>(cloud->size());
  EXPECT_NEAR(sum / n, 0, 5e-4);
  EXPECT_NEAR(std::sqrt(sum2 / n), 0.03, 6e-4);
}

TEST(Simulate, DropoutLosesTheAskedShare) {
  SimulateSettings settings = exact();
  settings.dropout = 0.1;
  const auto cloud = simulate(Ball(), sensor(16, 2048), settings);
  ASSERT_TRUE(cloud);
  EXPECT_NEAR(static_cast<double>(cloud->size()) / (16 * 2048), 0.9, 0.006);
  settings.dropout = 1;
  EXPECT_EQ(simulate(Ball(), sensor(), settings)->size(), 0u);
}

TEST(Simulate, RangesAreRoundedToTheUnit) {
  SimulateSettings settings = exact();
  settings.range_noise_m = 0.05;
  settings.range_unit_m = 0.004;
  const auto cloud = simulate(Ball(), sensor(), settings);
  ASSERT_TRUE(cloud);
  std::set<long> units;
  for (const Vec3& p : cloud->positions) {
    const double count = norm(p) / 0.004;
    EXPECT_NEAR(count, std::round(count), 1e-3);
    units.insert(std::lround(count));
  }
  EXPECT_GT(units.size(), 20u);
}

TEST(Simulate, RangeLimitsAndSkyGiveNoReturn) {
  SensorProfile profile = sensor();
  EXPECT_EQ(simulate(Ball(101), profile, exact())->size(), 0u);
  EXPECT_EQ(simulate(Ball(0.4), profile, exact())->size(), 0u);
  const auto cloud = simulate(Ball(10, 0), profile, exact());
  ASSERT_TRUE(cloud);
  ASSERT_GT(cloud->size(), 0u);
  for (const Vec3& p : cloud->positions) EXPECT_LE(p.z, 0);
  SimulateSettings noisy = exact();
  noisy.range_noise_m = 0.1;
  const auto cut = simulate(Ball(100), profile, noisy);
  ASSERT_TRUE(cut);
  EXPECT_NEAR(static_cast<double>(cut->size()), 0.5 * 8 * 512, 200);
  for (const Vec3& p : cut->positions) {
    ASSERT_LE(norm(p), 100 + 1e-5);
  }
}

TEST(Simulate, ThreadsNeverMatterSeedsDo) {
  const auto scene = make_scene("street", 3);
  ASSERT_TRUE(scene);
  SimulateSettings settings;
  settings.seed = 9;
  const auto one = simulate(**scene, sensor(16, 300), settings);
  settings.threads = 4;
  const auto four = simulate(**scene, sensor(16, 300), settings);
  settings.seed = 10;
  const auto other = simulate(**scene, sensor(16, 300), settings);
  ASSERT_TRUE(one && four && other);
  EXPECT_EQ(one->positions, four->positions);
  for (std::size_t a = 0; a < one->attributes.size(); ++a) {
    EXPECT_EQ(one->attributes[a].values, four->attributes[a].values);
  }
  EXPECT_NE(one->positions, other->positions);
}

TEST(Simulate, BadSettingsAreErrors) {
  const auto refused = [](auto change) {
    SimulateSettings settings;
    change(settings);
    const auto cloud = simulate(Ball(), sensor(), settings);
    return !cloud && cloud.error().code == ErrorCode::invalid_argument;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused([](auto& s) { s.range_noise_m = -1; }));
  EXPECT_TRUE(refused([&](auto& s) { s.range_noise_m = nan; }));
  EXPECT_TRUE(refused([](auto& s) { s.dropout = 1.5; }));
  EXPECT_TRUE(refused([&](auto& s) { s.dropout = nan; }));
  EXPECT_TRUE(refused([](auto& s) { s.range_unit_m = -0.1; }));
  EXPECT_TRUE(refused([](auto& s) { s.turns_per_second = 0; }));
  SensorProfile none = sensor();
  none.rings.clear();
  EXPECT_FALSE(simulate(Ball(), none));
}

std::vector<double> elevations(const SensorProfile& profile) {
  std::vector<double> angles;
  for (const Ring& ring : profile.rings) angles.push_back(ring.elevation);
  return angles;
}

TEST(SimulateTruth, EqualsNoiseFreeSimulationWhereDirectionsCoincide) {
  for (const std::string& name : scene_names()) {
    const auto scene = make_scene(name);
    ASSERT_TRUE(scene);
    const SensorProfile profile = sensor(8, 128);
    const auto scan = simulate(**scene, profile, exact());
    const Lattice lattice = Lattice::from_rings(elevations(profile), 128);
    const auto truth = simulate_truth(**scene, lattice, 2, 2, 0.5, 100);
    ASSERT_TRUE(scan && truth);
    ASSERT_EQ(truth->height, 16u);
    ASSERT_EQ(truth->width, 256u);
    std::size_t returns = 0;  // in dense cells with whole lattice coordinates
    for (std::size_t i = 1; i < 16; i += 2) {
      for (std::size_t j = 0; j < 256; j += 2) returns += is_return(truth->positions[i * 256 + j]);
    }
    EXPECT_EQ(returns, scan->size()) << name;
    std::size_t next = 0;
    for (std::size_t i = 1; i < 16; i += 2) {
      for (std::size_t j = 0; j < 256; j += 2) {
        const Vec3& p = truth->positions[i * 256 + j];
        if (!is_return(p) || next >= scan->size()) continue;
        ASSERT_NEAR(norm(p - scan->positions[next++]), 0, 2e-5) << name;
      }
    }
  }
}

TEST(SimulateTruth, FollowsTheDenseGridForFractionalFactors) {
  const Lattice lattice = Lattice::uniform(6, 40, 0.1, -0.4);
  const auto truth = simulate_truth(Ball(), lattice, 1.5, 0.7, 0, 100);
  ASSERT_TRUE(truth);
  const DenseGrid grid(lattice, 1.5, 0.7);
  ASSERT_EQ(truth->height, grid.rows);
  ASSERT_EQ(truth->width, grid.columns);
  EXPECT_EQ(truth->position_type, ScalarType::float64);
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const Vec3 expected = lattice.direction(grid.row(i), grid.column(j)) * 10;
      EXPECT_NEAR(norm(truth->positions[i * grid.columns + j] - expected), 0, 1e-12);
    }
  }
}

TEST(SimulateTruth, MissesAndLimitsAreNaN) {
  const Lattice lattice = Lattice::uniform(4, 8, 0.3, -0.3);
  const auto sky = simulate_truth(Ball(10, 0), lattice, 1, 1, 0, 100);
  ASSERT_TRUE(sky);
  EXPECT_EQ(count_returns(*sky), 16u);
  EXPECT_TRUE(std::isnan(sky->positions[0].x));
  EXPECT_EQ(count_returns(*simulate_truth(Ball(), lattice, 1, 1, 0, 9.9)), 0u);
  EXPECT_EQ(count_returns(*simulate_truth(Ball(), lattice, 1, 1, 10.1, 20)), 0u);
}

TEST(SimulateTruth, ThreadsNeverMatter) {
  const auto scene = make_scene("room", 2);
  const Lattice lattice = Lattice::uniform(16, 100, 0.3, -0.4);
  const auto one = simulate_truth(**scene, lattice, 1, 1, 0.1, 100, 1);
  const auto three = simulate_truth(**scene, lattice, 1, 1, 0.1, 100, 3);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(count_returns(*one), 1600u);
  EXPECT_EQ(one->positions, three->positions);
}

TEST(SimulateTruth, AbsurdGridsAreRefused) {
  const Lattice lattice = Lattice::uniform(64, 1024, 0.1, -0.4);
  const double infinity = std::numeric_limits<double>::infinity();
  const auto code = [&](double rows, double columns, double low, double high) {
    return simulate_truth(Ball(), lattice, rows, columns, low, high).error().code;
  };
  EXPECT_EQ(code(1e6, 1e6, 0, 1), ErrorCode::limit_exceeded);
  EXPECT_EQ(code(0, 1, 0, 1), ErrorCode::invalid_argument);
  EXPECT_EQ(code(1, -1, 0, 1), ErrorCode::invalid_argument);
  EXPECT_EQ(code(infinity, 1, 0, 1), ErrorCode::invalid_argument);
  EXPECT_EQ(code(1, 1, 5, 5), ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace curlidar
