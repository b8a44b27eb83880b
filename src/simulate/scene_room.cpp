// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>

#include "simulate/furniture.hpp"
#include "simulate/scenes.hpp"
#include "simulate/street_props.hpp"

namespace curlidar::scenery {

namespace {

constexpr double kHeight = 2.7, kSensorHeight = 1.15;
constexpr double kWest = -3.2, kEast = 3.0, kSouth = -2.4, kNorth = 2.6;
constexpr double kThick = 0.3;  // of walls
constexpr double kPi = std::numbers::pi;

/// Brushes of the walls: x runs along the wall, -y looks into the room.
struct Walls {
  Brush north, east, south, west;
};

void shell(const Brush& root) {
  root.of(0.45).box({kWest - 1, kSouth - 1, -0.2}, {kEast + 1, kNorth + 1, 0});
  const Brush ceiling = root.of(0.85);
  ceiling.box({kWest - 1, kSouth - 1, kHeight}, {kEast + 1, kNorth + 1, kHeight + 0.2});
  for (const double x : {-1.6, 0.0, 1.6}) {
    root.of(0.4).box({x - 0.08, kSouth, kHeight - 0.16}, {x + 0.08, kNorth, kHeight});
  }
  root.of(0.6).box({-1.6, -1.3, 0}, {1.1, 0.9, 0.012});  // a rug
}

/// A plain wall with skirting and cornice.
void wall(const Brush& brush, double length) {
  brush.of(0.75).box({0, 0, 0}, {length, kThick, kHeight});
}
void trims(const Brush& brush, double length) {
  brush.of(0.8).box({0, -0.018, 0}, {length, 0.01, 0.1});
  brush.of(0.85).box({0, -0.05, kHeight - 0.06}, {length, 0.01, kHeight});
}

void window_wall(const Brush& brush, double length) {
  const double middle = length / 2;
  brush.of(0.75).panel({0, 0, 0}, {length, kThick, kHeight}, {0.95, 0.85, 2.2, 0});
  brush.of(0.1).box({middle - 1.1, 0.2, 0.7}, {middle + 1.1, 0.24, 2.4});
  brush.of(0.85).box({middle - 1.1, -0.12, 0.8}, {middle + 1.1, 0.2, 0.85});  // the sill
  for (const double x : {-0.92, -0.03, 0.86}) {
    brush.of(0.85).box({middle + x, 0.15, 0.85}, {middle + x + 0.06, 0.2, 2.2});
  }
  radiator(brush.at({middle - 0.8, 0, 0}), 1.6);
  curtain(brush.at({middle - 1.7, -0.16, 0.08}), 0.7, 2.35, 0.05);
  curtain(brush.at({middle + 1.0, -0.16, 0.08}), 0.7, 2.35, 0.05);
}

void door_wall(const Brush& brush, double length) {
  brush.of(0.75).panel({0, 0, 0}, {1.6, kThick, kHeight}, {0.44, -1, 2.05, 0});
  brush.of(0.75).box({1.6, 0, 0}, {length, kThick, kHeight});
  const Brush leaf = brush.of(0.6);
  leaf.box({0.3, 0.16, 0}, {1.3, 0.2, 2.2});
  for (const double z : {0.25, 1.15}) leaf.box({0.5, 0.145, z}, {1.1, 0.17, z + 0.7});
  brush.of(0.9).ellipsoid({0.44, 0.1, 1.03}, {0.06, 0.025, 0.02});
  for (const double x : {0.28, 1.24}) {
    brush.of(0.85).box({x, -0.02, 0}, {x + 0.08, 0.01, 2.13});
  }
  brush.of(0.85).box({0.28, -0.02, 2.05}, {1.32, 0.01, 2.13});
}

void furnish(const Brush& root, const Walls& walls, Random& random) {
  const Brush desk = root.at({kWest + 0.25, -0.6, 0});
  table(desk, 0.9, 1.7);
  table_ware(root.at({kWest + 1.15, -0.6, 0}).turned(kPi / 2), random, 1.7, 0.9);
  for (const double y : {-0.2, 0.65}) {
    const double turn = kPi + random.uniform(-0.25, 0.25);
    chair(root.at({kWest + 1.55, y, 0}).turned(turn));
  }
  wall_relief(walls.west.at({1.5, 0, 1.25}), 1.5, 0.95);
  bookshelf(walls.south.at({0.3, -0.33, 0}), random, 2.4, 2.1);
  sofa(root.at({0.2, kSouth + 0.55, 0}).turned(kPi / 2).at({0, 1.4, 0}));
  wall_relief(walls.east.at({2.4, 0, 1.3}), 1.1, 0.8);
  sofa(root.at({kEast - 0.5, -0.9, 0}).turned(kPi));
  floor_lamp(root.at({kEast - 0.4, -2.05, 0}));
  potted_plant(root.at({kWest + 0.45, kNorth - 0.5, 0}), random);
  table(root.at({0.9, -1.3, -0.3}), 0.6, 0.9);  // low, its legs sunk into the floor
  root.of(0.85).frustum({0.2, 0.4, 2.15}, {0.2, 0.4, 2.4}, 0.28, 0.08);  // a hanging lamp
  root.of(0.2).cylinder({0.2, 0.4, 2.4}, {0.2, 0.4, kHeight}, 0.008);
  for (int i = 0; i < 4; ++i) {
    const Vec3 centre{random.uniform(-1.5, 1.5), random.uniform(0.9, 2), 0.09};
    root.of(random.uniform(0.3, 0.9)).ellipsoid(centre, {0.09, 0.09, 0.09});  // balls
  }
  person(root.at({1.7, 1.5, 0}).turned(-2.2), random);
}

}  // namespace

void draw_room(Sketch& sketch, std::uint64_t seed) {
  Random random(seed, 2);
  const Brush root = Brush(sketch).turned(0.21).at({-0.2, 0.15, -kSensorHeight});
  const double long_side = kEast - kWest, short_side = kNorth - kSouth;
  const Walls walls{root.at({kWest, kNorth, 0}), root.at({kEast, kNorth, 0}).turned(-kPi / 2),
                    root.at({kEast, kSouth, 0}).turned(kPi),
                    root.at({kWest, kSouth, 0}).turned(kPi / 2)};
  shell(root);
  window_wall(walls.north, long_side);
  door_wall(walls.east, short_side);
  wall(walls.south, long_side);
  wall(walls.west, short_side);
  trims(walls.north, long_side);
  trims(walls.south, long_side);
  trims(walls.west, short_side);
  trims(walls.east.at({1.6, 0, 0}), short_side - 1.6);
  furnish(root, walls, random);
}

}  // namespace curlidar::scenery
