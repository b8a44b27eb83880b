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

// Road coordinates: x along the road, y to the left from its middle, z up.
constexpr double kSensorHeight = 1.73;  // KITTI's HDL-64E
constexpr double kLane = -1.7;          // y of the sensor's lane
constexpr double kBend = 0.09;          // of the road against the sensor, radians
constexpr double kKerb = 5.5;           // half width of the road
constexpr double kKerbHeight = 0.13;
constexpr double kFront = 8.6;  // where pavements end and plots begin
constexpr double kStart = -90, kEnd = 112;
constexpr double kSideStart = 20, kSideEnd = 28;  // a street crosses here
constexpr double kReach = 62;                     // how far plots reach to either side

/// Height of the road's middle: a gentle slope with waves.
double grade(double x) {
  return 0.014 * x + 0.12 * std::sin(x / 15);
}

double road(double x, double y) {
  const double share = std::min(1.0, std::abs(y) / kKerb);
  return grade(x) - 0.09 * share * share;
}
double pavement(double x, double y) {
  return road(x, kKerb) + kKerbHeight + 0.015 * (std::abs(y) - kKerb);
}
bool on_side_street(double x) {
  return x > kSideStart && x < kSideEnd;
}
double ground(double x, double y) {
  return std::abs(y) < kKerb || on_side_street(x) ? road(x, y) : pavement(x, y);
}

class Street {
 public:
  Street(const Brush& root, std::uint64_t seed) : root_(root), random_(seed, 1) {}

  void draw() {
    surfaces();
    markings();
    for (const double side : {1.0, -1.0}) {
      plots(side);
      parked_cars(side);
      furniture(side);
      walkers(side);
    }
    traffic();
  }

 private:
  Brush stand(double x, double y, double yaw) const {
    return root_.at({x, y, ground(x, y)}).turned(yaw);
  }
  bool near_side_street(double x, double margin) const {
    return x > kSideStart - margin && x < kSideEnd + margin;
  }

  /// A strip of ground between two lines along the road.
  template <class Height>
  void strip(double x0, double x1, double y0, double y1, int columns, double reflectivity,
             const Height& height) const {
    const int rows = static_cast<int>((x1 - x0) / 2) + 1;
    root_.of(reflectivity).sheet(rows + 1, columns + 1, [&](int i, int j) {
      const double x = x0 + (x1 - x0) * i / rows, y = y0 + (y1 - y0) * j / columns;
      return Vec3{x, y, height(x, y)};
    });
  }

  void surfaces() const {
    strip(kStart, kEnd, -kKerb, kKerb, 12, 0.18, road);
    for (const double side : {1.0, -1.0}) {
      footway(side, kStart, kSideStart);
      footway(side, kSideEnd, kEnd);
      strip(kSideStart, kSideEnd, side * kKerb, side * kReach, 8, 0.18, road);
      for (const double x : {kSideStart, kSideEnd}) {  // kerbs of the side street
        root_.of(0.5).quad({x, side * kKerb, road(x, kKerb)}, {x, side * kReach, road(x, kReach)},
                           {x, side * kReach, pavement(x, kReach)},
                           {x, side * kKerb, pavement(x, kKerb)});
      }
    }
  }

  /// Pavement, plots behind it and the kerb before it.
  void footway(double side, double x0, double x1) const {
    strip(x0, x1, side * kKerb, side * kFront, 2, 0.38, pavement);
    strip(x0, x1, side * kFront, side * kReach, 6, 0.45, pavement);
    const int rows = static_cast<int>((x1 - x0) / 2) + 1;
    root_.of(0.5).sheet(rows + 1, 2, [&](int i, int j) {
      const double x = x0 + (x1 - x0) * i / rows;
      return Vec3{x, side * kKerb, j == 0 ? road(x, kKerb) : pavement(x, kKerb)};
    });
  }

  /// Thermoplastic paint, 4 mm thick.
  void paint(double x0, double x1, double y0, double y1) const {
    strip(x0, x1, y0, y1, 1, 0.9, [](double x, double y) { return road(x, y) + 0.004; });
  }
  void markings() const {
    for (double x = kStart; x < kEnd - 3; x += 9) {
      if (!near_side_street(x + 1.5, 6)) paint(x, x + 3, -0.07, 0.07);
    }
    for (double y = -5; y < 5; y += 1) paint(14.5, 17.5, y, y + 0.5);  // a zebra crossing
    for (double x = kStart; x < kEnd - 6; x += 5.6) {                  // parking bays
      if (near_side_street(x, 7)) continue;
      paint(x, x + 0.1, 3.4, 5.3);
      paint(x, x + 0.1, -5.3, -3.4);
    }
  }

  void plots(double side) {
    const bool gardens = side < 0;
    double x = kStart + random_.uniform(0, 5);
    while (x < kEnd - 12) {
      HouseStyle style;
      style.length_m = random_.uniform(9, 16);
      style.depth_m = random_.uniform(9, 12);
      style.storeys = 2 + random_.below(3);
      style.gable = random_.chance(0.7);
      if (x < kSideStart && x + style.length_m > kSideStart - 2) {
        if (kSideStart - 2 - x > 6) {
          style.length_m = kSideStart - 2 - x;
        } else {
          x = kSideEnd + 2;
        }
      }
      const double front = kFront + (gardens ? random_.uniform(2.5, 4) : random_.uniform(0, 0.4));
      plot(x, side, front, style, gardens);
      x += style.length_m + (random_.chance(0.45) ? random_.uniform(2, 5) : 0);
    }
    // Beyond the crossing, houses along the side street close the view.
    HouseStyle style;
    style.length_m = 16;
    const double yaw = side > 0 ? 0 : std::numbers::pi;
    const double start = side > 0 ? kSideStart - 4 : kSideEnd + 4;
    house(stand(start, side * 50, yaw), random_, style);
  }

  void plot(double x, double side, double front, const HouseStyle& style, bool garden) {
    // A house's front looks to its own -y; on the right side of the road it is turned around.
    const double middle = x + style.length_m / 2;
    const Brush base = root_.at({middle, side * front, pavement(middle, front)});
    const double half = style.length_m / 2;
    const Brush turned = side > 0 ? base : base.turned(std::numbers::pi);
    house(turned.at({-half, 0, 0}), random_, style);
    if (!garden) return;
    const double line = side * (kFront + 0.4);
    const Brush edge = root_.at({x, line, pavement(middle, kFront)});
    if (random_.chance(0.5)) {
      hedge(edge, random_, 0.4 * style.length_m, random_.uniform(0.9, 1.4));
    } else {
      fence(edge, 0.4 * style.length_m, 1.05);
    }
    edge.at({0.6 * style.length_m, 0, 0})
        .of(0.5)
        .box({0, -0.12, -0.3}, {0.4 * style.length_m, 0.12, 0.7});
    for (int i = 0; i < 2; ++i) {
      const double bx = x + random_.uniform(1, style.length_m - 1);
      const double by = side * (front - random_.uniform(0.8, 1.6));
      const double radius = random_.uniform(0.35, 0.7);
      bush(stand(bx, by, 0), random_, radius, 60);
    }
  }

  void parked_cars(double side) {
    for (double x = kStart + 3; x < kEnd - 6; x += 5.6) {
      if (near_side_street(x, 8) || random_.chance(0.38)) continue;
      if (std::abs(x) < 6 && side < 0) continue;  // room to breathe beside the sensor
      const double px = x + random_.uniform(-0.3, 0.3);
      const double y = side * (4.45 + random_.uniform(-0.12, 0.12));
      const double heading = side < 0 ? 0 : std::numbers::pi;
      const double skew = random_.uniform(-0.04, 0.04);
      car(stand(px, y, heading + skew), random_);
    }
  }

  void furniture(double side) {
    const double line = side * 6.1;
    for (double x = kStart + 8; x < kEnd - 5; x += 13) {
      const double tx = x + random_.uniform(-1.5, 1.5);
      if (near_side_street(tx, 3)) continue;
      TreeStyle style;
      style.height_m = random_.uniform(4.2, 6);
      style.crown_radius_m = random_.uniform(1.7, 2.6);
      style.trunk_radius_m = random_.uniform(0.11, 0.2);
      tree(stand(tx, line, 0), random_, style);
    }
    for (double x = kStart + 2; x < kEnd - 5; x += 26) {
      if (!near_side_street(x, 2)) lamp_post(stand(x, line, side > 0 ? -1.57 : 1.57), 6.5);
    }
    for (const double x : {-31.0, 12.5, 18.8, 30.2, 55.0}) {
      sign(stand(x, side * 6.0, std::numbers::pi), random_);
    }
    for (double x = kSideStart - 9; x < kSideStart - 1; x += 1.4) bollard(stand(x, side * 5.75, 0));
    for (const double x : {-14.0, 8.0, 41.0}) {
      const double bx = x + random_.uniform(-4, 4);
      wheelie_bin(stand(bx, side * 8.1, side > 0 ? -1.57 : 1.57));
      bicycle(stand(bx + 2.2, side * 7.9, random_.uniform(-0.2, 0.2)));
    }
    bench(stand(-7.5, side * 7.9, side > 0 ? -1.57 : 1.57));
  }

  void walkers(double side) {
    for (int i = 0; i < 6; ++i) {
      const double x = random_.uniform(-30, 45);
      const double y = side * random_.uniform(6.7, 7.6);
      if (!on_side_street(x))
        person(stand(x, y, random_.chance(0.5) ? 0 : std::numbers::pi), random_);
    }
    person(stand(15.5 + side, side * 1.8, side * 1.5), random_);  // on the crossing
  }

  void traffic() {
    car(stand(11.5, -1.75, 0), random_);
    car(stand(-17, -1.7, 0.02), random_);
    car(stand(33, 1.7, std::numbers::pi), random_);
    car(stand(-9, 1.75, std::numbers::pi), random_);
    car(stand(24, 15, -1.57), random_);
    HouseStyle style;
    style.length_m = 40;
    house(stand(kEnd - 2, 20, -std::numbers::pi / 2), random_, style);
  }

  Brush root_;
  Random random_;
};

}  // namespace

void draw_street(Sketch& sketch, std::uint64_t seed) {
  const Brush root = Brush(sketch).turned(kBend).at({0, -kLane, -road(0, kLane) - kSensorHeight});
  Street(root, seed).draw();
}

}  // namespace curlidar::scenery
