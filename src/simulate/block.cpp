// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/block.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "simulate/buildings.hpp"
#include "simulate/plants.hpp"
#include "simulate/street_props.hpp"

namespace curlidar::scenery {

namespace {

constexpr double kPi = std::numbers::pi;
// The street's middle is a rectangle of straights with quarters of circles for corners, driven
// counter-clockwise from the left end of the lower straight.
constexpr double kLong = 90, kShort = 46;  // straights, metres
constexpr double kCorner = 14;             // radius
constexpr double kArc = kCorner * kPi / 2;
constexpr double kRoad = 4.5;    // half width of the road
constexpr double kPavement = 7;  // where pavements end
constexpr double kKerbHeight = 0.13;
constexpr double kMargin = 60;  // ground beyond the street
constexpr double kCell = 2;     // of the ground's mesh, metres

/// A straight of the street, and the corner after it.
struct Side {
  double x, y, yaw, length;
};
constexpr double kWest = -kLong / 2, kEast = kLong / 2;
constexpr double kSouth = -kShort / 2 - kCorner, kNorth = kShort / 2 + kCorner;
constexpr std::array<Side, 4> kSides = {{{kWest, kSouth, 0, kLong},
                                         {kEast + kCorner, -kShort / 2, kPi / 2, kShort},
                                         {kEast, kNorth, kPi, kLong},
                                         {kWest - kCorner, kShort / 2, -kPi / 2, kShort}}};

/// A place in the plane.
struct FlatPlace {
  double x, y, yaw;
};

FlatPlace beside(double x, double y, double yaw, double left) {
  return {x - left * std::sin(yaw), y + left * std::cos(yaw), yaw};
}

FlatPlace flat_street(double along, double left) {
  double s = along - std::floor(along / block_lap_m()) * block_lap_m();
  for (const Side& side : kSides) {
    const double ahead_x = std::cos(side.yaw), ahead_y = std::sin(side.yaw);
    if (s < side.length) {
      return beside(side.x + s * ahead_x, side.y + s * ahead_y, side.yaw, left);
    }
    s -= side.length;
    if (s < kArc) {
      const FlatPlace centre =
          beside(side.x + side.length * ahead_x, side.y + side.length * ahead_y, side.yaw, kCorner);
      const double yaw = side.yaw + s / kCorner;
      return beside(centre.x + kCorner * std::sin(yaw), centre.y - kCorner * std::cos(yaw), yaw,
                    left);
    }
    s -= kArc;
  }
  return flat_street(0, left);  // rounding at the end of the lap
}

class Block {
 public:
  Block(Sketch& sketch, std::uint64_t seed) : root_(sketch), random_(seed, 11) {}

  void draw() {
    ground();
    paving();
    for (std::size_t i = 0; i < kSides.size(); ++i) {
      for (const double out : {1.0, -1.0}) {
        houses(kSides[i], start_of(i), out);
        parked(start_of(i), kSides[i].length, out);
        furniture(start_of(i), kSides[i].length, out);
      }
    }
    garden();
  }

 private:
  static double start_of(std::size_t side) {
    double s = 0;
    for (std::size_t i = 0; i < side; ++i) s += kSides[i].length + kArc;
    return s;
  }
  Brush stand(double along, double left, double turn, double lift = 0) const {
    const StreetPlace place = block_street(along, left);
    return root_.at(place.position + Vec3{0, 0, lift}).turned(place.yaw + turn);
  }

  void ground() const {
    const double x0 = kWest - kCorner - kMargin, y0 = kSouth - kMargin;
    const int rows = static_cast<int>(-2 * x0 / kCell), columns = static_cast<int>(-2 * y0 / kCell);
    root_.of(0.45).sheet(rows + 1, columns + 1, [&](int i, int j) {
      const double x = x0 + i * kCell, y = y0 + j * kCell;
      return Vec3{x, y, block_ground(x, y)};
    });
  }

  /// A strip along the street between two lines beside its middle, `lift` above the ground there.
  void strip(double from, double to, double lift_from, double lift_to, int columns,
             double reflectivity) const {
    const int rows = static_cast<int>(block_lap_m() / 1.5);
    root_.of(reflectivity).sheet(rows + 1, columns + 1, [&](int i, int j) {
      const double share = static_cast<double>(j) / columns;
      const StreetPlace place =
          block_street(i == rows ? 0 : i * block_lap_m() / rows, from + share * (to - from));
      return place.position + Vec3{0, 0, lift_from + share * (lift_to - lift_from)};
    });
  }

  void paving() const {
    strip(-kRoad, kRoad, 0.06, 0.06, 4, 0.18);
    for (const double out : {1.0, -1.0}) {
      strip(out * kRoad, out * kRoad, 0.06, 0.06 + kKerbHeight, 1, 0.5);
      strip(out * kRoad, out * kPavement, 0.06 + kKerbHeight, 0.1 + kKerbHeight, 2, 0.38);
      strip(out * kPavement, out * kPavement, 0.1 + kKerbHeight, -0.2, 1, 0.4);
    }
  }

  /// Houses along a straight; `out`: 1 within the block, left of the street, -1 outside of it.
  void houses(const Side& side, double start, double out) {
    double x = random_.uniform(0, 3);
    while (x < side.length - 9) {
      HouseStyle style;
      style.length_m = random_.uniform(9, std::min(15.0, side.length - x));
      style.depth_m = random_.uniform(7, 9);
      style.storeys = 2 + random_.below(2);
      style.gable = random_.chance(0.7);
      const bool fenced = random_.chance(0.5);
      const double front = kPavement + (fenced ? random_.uniform(2.5, 3.5) : 0.4);
      // A front looks to its own -y.
      const double from = out > 0 ? start + x : start + x + style.length_m;
      house(stand(from, out * front, out > 0 ? 0 : kPi, -0.1), random_, style);
      if (fenced) front_garden(from, out, style.length_m, front);
      x += style.length_m + (random_.chance(0.4) ? random_.uniform(2, 6) : 0);
    }
  }

  void front_garden(double from, double out, double length, double front) {
    const Brush edge = stand(from, out * (kPavement + 0.3), out > 0 ? 0 : kPi);
    if (random_.chance(0.5)) {
      hedge(edge, random_, 0.7 * length, random_.uniform(0.8, 1.3));
    } else {
      fence(edge, 0.7 * length, 1.05);
    }
    const double along = random_.uniform(1, length - 1);
    const double radius = random_.uniform(0.35, 0.7);
    bush(stand(from + out * along, out * (front - 1), 0), random_, radius, 50);
  }

  void parked(double start, double length, double out) {
    for (double x = 4; x < length - 4; x += 5.8) {
      if (random_.chance(0.45)) continue;
      const double shift = random_.uniform(-0.25, 0.25);
      const double skew = random_.uniform(-0.04, 0.04);
      car(stand(start + x + shift, out * (kRoad - 1.05), (out > 0 ? kPi : 0) + skew, 0.06),
          random_);
    }
  }

  void furniture(double start, double length, double out) {
    const double line = out * 5.2, lift = 0.06 + kKerbHeight;
    for (double x = 3; x < length; x += 12) {
      TreeStyle style;
      const double along = start + x + random_.uniform(-1.5, 1.5);
      style.height_m = random_.uniform(4.2, 6);
      style.crown_radius_m = random_.uniform(1.6, 2.4);
      style.trunk_radius_m = random_.uniform(0.11, 0.2);
      tree(stand(along, line, 0, lift), random_, style);
    }
    for (double x = 9; x < length; x += 24) {
      lamp_post(stand(start + x, line, out > 0 ? -kPi / 2 : kPi / 2, lift), 6.5);
    }
    sign(stand(start + length - 2, out * 5.4, kPi, lift), random_);
    wheelie_bin(stand(start + random_.uniform(5, length - 5), out * 6.6, 0, lift));
    bicycle(stand(start + random_.uniform(5, length - 5), out * 6.5, 0, lift));
  }

  /// Trees in the middle of the block and around it.
  void garden() {
    for (int i = 0; i < 30; ++i) {
      TreeStyle style;
      const bool inside = i < 6;
      const double along = random_.uniform(0, block_lap_m());
      const double left = inside ? random_.uniform(20, 30) : random_.uniform(-45, -22);
      style.height_m = random_.uniform(5, 8);
      style.crown_radius_m = random_.uniform(2, 3);
      style.trunk_radius_m = random_.uniform(0.15, 0.3);
      const StreetPlace place = block_street(along, left);
      if (inside && std::abs(place.position.x) > kEast) continue;
      tree(root_.at(place.position), random_, style);
    }
  }

  Brush root_;
  Random random_;
};

/// How something moves along the street.
struct Mover {
  double start, left, speed;  // metres along at time 0, metres beside the middle, metres a second
};

}  // namespace

double block_lap_m() {
  return 2 * (kLong + kShort) + 4 * kArc;
}

double block_ground(double x, double y) {
  return 0.5 * std::sin(x / 41) * std::cos(y / 37) + 0.008 * x;
}

StreetPlace block_street(double along, double left) {
  const FlatPlace place = flat_street(along, left);
  return {{place.x, place.y, block_ground(place.x, place.y)}, place.yaw};
}

void draw_block(Sketch& sketch, std::uint64_t seed) {
  Block(sketch, seed).draw();
}

void draw_traffic(Sketch& sketch, std::uint64_t seed, double time_s, const Vec3& near,
                  double reach_m) {
  constexpr int kCars = 7, kWalkers = 16;
  const Brush root(sketch);
  for (int i = 0; i < kCars + kWalkers; ++i) {
    Random random(seed, 100 + static_cast<std::uint64_t>(i));
    const bool is_car = i < kCars;
    const double way = is_car || random.chance(0.5) ? -1 : 1;
    Mover mover{random.uniform(0, block_lap_m()), 1.7, 0};
    mover.speed = way * (is_car ? random.uniform(6, 10) : random.uniform(1, 1.6));
    if (i == 0) mover = {24, -1.7, 10};  // one goes ahead, the others come
    if (!is_car) mover.left = (random.chance(0.5) ? 1 : -1) * random.uniform(5.8, 6.6);
    const StreetPlace place = block_street(mover.start + mover.speed * time_s, mover.left);
    const double lift = is_car ? 0.06 : 0.08 + kKerbHeight;
    if (norm(place.position - near) > reach_m) continue;
    const Brush brush =
        root.at(place.position + Vec3{0, 0, lift}).turned(place.yaw + (mover.speed < 0 ? kPi : 0));
    if (is_car) {
      car(brush, random);
    } else {
      person(brush, random);
    }
  }
}

}  // namespace curlidar::scenery
