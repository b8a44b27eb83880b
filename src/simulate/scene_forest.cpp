// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/plants.hpp"
#include "simulate/scenes.hpp"

namespace curlidar::scenery {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kSensorHeight = 1.5;
constexpr double kReach = 75;  // radius of the ground
constexpr double kEdge = 62;   // radius of the wood

/// Smooth noise: random heights on a unit grid, blended with the cubic smooth step.
double value_noise(std::uint64_t seed, double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto corner = [&](double cx, double cy) {
    const auto key = [](double c) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(c));
    };
    return 2 * unit_interval(keyed_bits(seed, key(cx), key(cy), 77)) - 1;
  };
  const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
  const double u = smooth(x - fx), v = smooth(y - fy);
  const double low = std::lerp(corner(fx, fy), corner(fx + 1, fy), u);
  const double high = std::lerp(corner(fx, fy + 1), corner(fx + 1, fy + 1), u);
  return std::lerp(low, high, v);
}

class Forest {
 public:
  Forest(const Brush& brush, std::uint64_t seed) : seed_(seed), random_(seed, 3), root_(brush) {
    root_ = brush.at({0, 0, -kSensorHeight - height(0, 0)});
  }

  void draw() {
    ground();
    for (int i = 0; i < 170; ++i) large_plant();
    for (int i = 0; i < 70; ++i) undergrowth();
    for (int i = 0; i < 160; ++i) grass();
    for (int i = 0; i < 12; ++i) lying_log();
    for (int i = 0; i < 25; ++i) rock();
  }

 private:
  struct Place {
    double x, y, distance;
  };

  double height(double x, double y) const {
    return 0.03 * x + 1.6 * value_noise(seed_, x / 18, y / 18) +
           0.35 * value_noise(seed_ + 1, x / 5, y / 5) +
           0.07 * value_noise(seed_ + 2, x / 1.3, y / 1.3);
  }
  Brush stand(const Place& place) const {
    return root_.at({place.x, place.y, height(place.x, place.y)});
  }
  /// Uniform over the disc between two radii.
  Place somewhere(double from, double to) {
    const double r = std::sqrt(random_.uniform(from * from, to * to));
    const double angle = random_.uniform(0, kTurn);
    return {r * std::cos(angle), r * std::sin(angle), r};
  }

  /// A mesh whose cells grow with the distance from the sensor.
  void ground() const {
    constexpr int kRings = 84, kSpokes = 150;
    root_.of(0.3).sheet(kRings, kSpokes + 1, [&](int i, int j) {
      const double r = kReach * std::pow(static_cast<double>(i) / (kRings - 1), 2.2);
      const double angle = kTurn * (j % kSpokes) / kSpokes;
      const double x = r * std::cos(angle), y = r * std::sin(angle);
      return Vec3{x, y, height(x, y)};
    });
  }

  void large_plant() {
    const Place place = somewhere(2.8, kEdge);
    const bool near = place.distance < 30;
    if (random_.chance(0.3)) {
      const double tall = random_.uniform(3, near ? 9 : 14);
      fir(stand(place), random_, tall);
      return;
    }
    TreeStyle style;
    style.height_m = random_.uniform(5, 11);
    style.trunk_radius_m = random_.uniform(0.08, 0.28);
    style.crown_radius_m = random_.uniform(1.5, 3);
    style.leaves = near ? 150 : 60;
    style.branches = near ? 10 : 5;
    tree(stand(place), random_, style);
  }

  void undergrowth() {
    const Place place = somewhere(2.2, 40);
    const double radius = random_.uniform(0.3, 0.9);
    bush(stand(place), random_, radius, 70);
  }

  void grass() {
    const Place place = somewhere(1.5, 14);
    const double tall = random_.uniform(0.25, 0.7);
    tuft(stand(place), random_, tall);
  }

  void lying_log() {
    const Place place = somewhere(3, 30);
    const double angle = random_.uniform(0, kTurn);
    const double length = random_.uniform(2, 6);
    const double radius = random_.uniform(0.1, 0.25);
    const double x = place.x + length * std::cos(angle), y = place.y + length * std::sin(angle);
    root_.of(0.35).frustum({place.x, place.y, height(place.x, place.y) + radius},
                           {x, y, height(x, y) + 0.7 * radius}, radius, 0.7 * radius);
  }

  void rock() {
    const Place place = somewhere(2.5, 35);
    const double size = random_.uniform(0.15, 0.8);
    const double turn = random_.uniform(0, kTurn);
    stand(place).turned(turn).of(0.5).ellipsoid({}, {size, 0.7 * size, 0.5 * size});
  }

  std::uint64_t seed_;
  Random random_;
  Brush root_;
};

}  // namespace

void draw_forest(Sketch& sketch, std::uint64_t seed) {
  Forest(Brush(sketch), seed).draw();
}

}  // namespace curlidar::scenery
