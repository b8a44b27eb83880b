// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/buildings.hpp"
#include "simulate/plants.hpp"
#include "simulate/scenes.hpp"
#include "simulate/street_props.hpp"

namespace curlidar::scenery {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSensorHeight = 1.5;
constexpr double kHalfX = 28, kHalfY = 24;      // of the quadrangle
constexpr double kLawnX = 22.5, kLawnY = 18.5;  // of the lawn inside the gravel walk
constexpr double kSensorX = -5, kSensorY = -4;
constexpr double kFloor = 4.4;  // height of the ground floor
constexpr double kWalk = 3.4;   // depth of a cloister behind its arches

/// Gravel around a slightly domed lawn with a mound in one corner; the lawn's edge is 7 cm high.
double ground(double x, double y) {
  const double gravel = 0.01 * x + 0.05 * std::sin(x / 9) * std::cos(y / 7);
  if (std::abs(x) > kLawnX || std::abs(y) > kLawnY) return gravel;
  const double dx = x - 14, dy = y - 10;
  const double mound = 1.9 * std::exp(-(dx * dx + dy * dy) / 18);
  return gravel + 0.07 + 0.02 * std::sin(x * 1.1) * std::sin(y * 1.3) + mound;
}

class College {
 public:
  College(const Brush& root, std::uint64_t seed) : root_(root), random_(seed, 5) {}

  void draw() {
    surfaces();
    range({-kHalfX, kHalfY, 0}, 0, 2 * kHalfX, true);
    range({kHalfX, kHalfY, 0}, -kPi / 2, 2 * kHalfY, false);
    range({kHalfX, -kHalfY, 0}, kPi, 2 * kHalfX, false);
    range({-kHalfX, -kHalfY, 0}, kPi / 2, 2 * kHalfY, true);
    tower({kHalfX + 3, kHalfY + 3, 0});
    statue();
    garden();
    people();
  }

 private:
  Brush stand(double x, double y, double yaw = 0) const {
    return root_.at({x, y, ground(x, y)}).turned(yaw);
  }

  void surfaces() const {
    const double outer = 9;
    root_.of(0.4).sheet(54, 48, [&](int i, int j) {  // gravel, below the lawn as well
      const double x = -kHalfX - outer + (2 * kHalfX + 2 * outer) * i / 53.0;
      const double y = -kHalfY - outer + (2 * kHalfY + 2 * outer) * j / 47.0;
      const double gravel = 0.01 * x + 0.05 * std::sin(x / 9) * std::cos(y / 7);
      return Vec3{x, y, gravel};
    });
    constexpr int kRows = 90, kColumns = 74;
    root_.of(0.6).sheet(kRows + 1, kColumns + 1, [&](int i, int j) {
      const double x = -kLawnX + 2 * kLawnX * i / kRows, y = -kLawnY + 2 * kLawnY * j / kColumns;
      return Vec3{x, y, ground(x, y)};
    });
    for (const double side : {1.0, -1.0}) {  // the lawn's stone border
      root_.of(0.5).box({-kLawnX, side * kLawnY - 0.08, -0.5}, {kLawnX, side * kLawnY + 0.08, 0.1});
      root_.of(0.5).box({side * kLawnX - 0.08, -kLawnY, -0.5}, {side * kLawnX + 0.08, kLawnY, 0.1});
    }
  }

  /// One side of the quadrangle: x along the wall, -y to the lawn.
  void range(const Vec3& corner, double yaw, double length, bool cloister) {
    const Brush wall = root_.at(corner).turned(yaw);
    const Brush stone = wall.of(0.55);
    const double depth = 8;
    if (cloister) {
      arcade(stone, {length, kFloor, 0.6, static_cast<int>(length / 4), 0.7, 2.3});
      stone.box({0, kWalk, -1}, {length, depth, kFloor});
      stone.box({0, 0, kFloor - 0.15}, {length, kWalk, kFloor});
      for (double x = 6; x < length - 3; x += 12) {  // doors at the back of the cloister
        stone.of(0.35).box({x, kWalk - 0.1, -0.5}, {x + 1.3, kWalk, 2.2});
      }
    } else {
      ground_floor(stone, length);
      stone.box({0, 0.55, -1}, {length, depth, kFloor});
    }
    window_row(stone,
               {length, kFloor, 8.2, 0.5, static_cast<int>(length / 3.2), 1.2, 0.8, 2.1, 0.6});
    window_row(stone, {length, 8.2, 11.6, 0.5, static_cast<int>(length / 3.2), 1.1, 0.8, 2.2, 0});
    stone.box({0, 0.5, kFloor}, {length, depth, 11.6});
    wall.of(0.65).box({0, -0.18, 8.1}, {length, 0.1, 8.3});
    wall.of(0.65).box({0, -0.22, 11.5}, {length, 0.5, 11.75});
    for (double x = 0.3; x < length - 1; x += 1.9) stone.box({x, 0, 11.7}, {x + 1.1, 0.4, 12.7});
    gable_roof(wall.of(0.35), length, depth, 11.9, 2.6);
    for (double x = 5; x < length; x += 11) wall.of(0.4).box({x, 5, 12}, {x + 1, 6, 15.6});
  }

  /// Windows and buttresses, with a gateway in the middle.
  void ground_floor(const Brush& stone, double length) const {
    const double gate = length / 2;
    window_row(stone, {gate - 2.5, -0.6, kFloor, 0.55, static_cast<int>((gate - 2.5) / 3.2), 1.3,
                       1.7, 3.2, 0.5});
    window_row(
        stone.at({gate + 2.5, 0, 0}),
        {gate - 2.5, -0.6, kFloor, 0.55, static_cast<int>((gate - 2.5) / 3.2), 1.3, 1.7, 3.2, 0.5});
    stone.panel({gate - 2.5, -0.25, -1}, {gate + 2.5, 0.55, kFloor}, {1.5, -1, 2.0, 1.5});
    stone.of(0.3).box({gate - 2, 0.5, -1}, {gate + 2, 0.56, kFloor});
    for (double x = 3.2; x < length - 2; x += 6.4) {
      if (std::abs(x - gate) < 3.4) continue;
      stone.box({x - 0.3, -0.55, -1}, {x + 0.3, 0, 3.0});
      stone.quad({x - 0.3, -0.55, 3.0}, {x + 0.3, -0.55, 3.0}, {x + 0.3, 0, 3.9},
                 {x - 0.3, 0, 3.9});
    }
  }

  void tower(const Vec3& foot) const {
    const Brush stone = root_.at(foot).of(0.5);
    stone.box({-3.5, -3.5, -1}, {3.5, 3.5, 19});
    for (const double x : {-3.3, 3.3}) {
      for (const double y : {-3.3, 3.3}) stone.frustum({x, y, 19}, {x, y, 22.5}, 0.5, 0.05);
    }
    stone.frustum({0, 0, 19}, {0, 0, 27}, 3, 0.1);
  }

  void statue() const {
    const Brush base = stand(0, 0).of(0.6);
    base.cylinder({0, 0, -0.5}, {0, 0, 0.25}, 1.5);
    base.cylinder({0, 0, 0.25}, {0, 0, 0.45}, 1.1);
    base.box({-0.5, -0.5, 0.4}, {0.5, 0.5, 1.7});
    base.box({-0.6, -0.6, 1.7}, {0.6, 0.6, 1.85});
    const Brush bronze = base.at({0, 0, 1.85}).of(0.3);
    bronze.frustum({0, 0, 0}, {0, 0, 1.2}, 0.38, 0.2);
    bronze.ellipsoid({0, 0, 1.35}, {0.2, 0.28, 0.3});
    bronze.ellipsoid({0, 0, 1.78}, {0.11, 0.1, 0.14});
    bronze.cylinder({0, 0.25, 1.5}, {0.5, 0.35, 1.75}, 0.06);
  }

  void garden() {
    const double spots[][2] = {{14, 10}, {17, -12}, {-15, 13}, {-18, -13},
                               {6, 15},  {4, -15},  {20, 2}};
    for (const auto& spot : spots) {
      const double x = spot[0] + random_.uniform(-1, 1), y = spot[1] + random_.uniform(-1, 1);
      TreeStyle style;
      style.height_m = random_.uniform(4.5, 7);
      style.crown_radius_m = random_.uniform(2.2, 3.4);
      style.trunk_radius_m = random_.uniform(0.18, 0.32);
      style.leaves = 380;
      style.branches = 10;
      tree(stand(x, y), random_, style);
    }
    for (const double x : {-16.0, -6.0, 6.0, 16.0}) {
      bench(stand(x, kLawnY + 0.9, -kPi / 2));
      bench(stand(x, -kLawnY - 0.9, kPi / 2));
    }
    for (const double y : {-14.0, 4.0}) {
      hedge(stand(-kLawnX + 1, y, kPi / 2), random_, 9, 1.1);
      hedge(stand(kLawnX - 1, y, kPi / 2), random_, 7, 0.9);
    }
    for (int i = 0; i < 16; ++i) {
      const double x = random_.uniform(8, 20), y = random_.uniform(4, 16);
      const double radius = random_.uniform(0.3, 0.7);
      bush(stand(x, y), random_, radius, 60);
    }
    for (const double x : {-24.5, 0.0, 24.5}) {
      lamp_post(stand(x, -20.5, kPi / 2), 3.6);
      lamp_post(stand(x, 20.5, -kPi / 2), 3.6);
    }
  }

  void people() {
    for (int i = 0; i < 9; ++i) {
      const double x = random_.uniform(-20, 20), y = random_.uniform(-17, 17);
      if (std::hypot(x - kSensorX, y - kSensorY) < 2.5 || std::hypot(x, y) < 2) continue;
      const double yaw = random_.uniform(-kPi, kPi);
      person(stand(x, y, yaw), random_);
    }
  }

  Brush root_;
  Random random_;
};

}  // namespace

void draw_college(Sketch& sketch, std::uint64_t seed) {
  const Brush root = Brush(sketch).turned(0.3).at(
      {-kSensorX, -kSensorY, -ground(kSensorX, kSensorY) - kSensorHeight});
  College(root, seed).draw();
}

}  // namespace curlidar::scenery
