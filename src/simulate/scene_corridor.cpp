// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>

#include "simulate/furniture.hpp"
#include "simulate/scenes.hpp"
#include "simulate/street_props.hpp"

namespace curlidar::scenery {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHeight = 2.75, kSensorHeight = 1.2;
constexpr double kHalf = 1.25;   // half width of the hallway
constexpr double kThick = 0.25;  // of its walls
constexpr double kBay = 4.0;
constexpr int kBays = 15;
constexpr double kStart = -22, kEnd = kStart + kBays * kBay;
constexpr double kRooms = 5.5;  // depth of the rooms on either side

class Corridor {
 public:
  Corridor(const Brush& root, std::uint64_t seed) : root_(root), random_(seed, 4) {}

  void draw() {
    shell();
    for (const double side : {1.0, -1.0}) {
      for (int i = 0; i < kBays; ++i) bay(side, i);
    }
    for (int i = 0; i <= kBays; ++i) frame(kStart + i * kBay);
    ends();
    things();
  }

 private:
  void shell() const {
    const double reach = kHalf + kThick + kRooms + 1;
    root_.of(0.35).box({kStart - 1, -reach, -0.2}, {kEnd + 1, reach, 0});
    root_.of(0.85).box({kStart - 1, -reach, kHeight}, {kEnd + 1, reach, kHeight + 0.2});
    for (const double side : {1.0, -1.0}) {
      const double y = side * (kHalf + kThick + kRooms + 0.5);
      root_.of(0.7).box({kStart - 1, y - 0.5, 0}, {kEnd + 1, y + 0.5, kHeight});
    }
    root_.of(0.5).box({kStart, 0.55, kHeight - 0.18}, {kEnd, 0.95, kHeight - 0.1});  // cable tray
    for (const double y : {-0.85, -0.98}) {
      root_.of(0.6).cylinder({kStart, y, kHeight - 0.14}, {kEnd, y, kHeight - 0.14}, 0.045);
    }
  }

  /// One bay of a wall: a door, shut or open, or a way out to the side.
  void bay(double side, int index) {
    // x along the wall, y away from the hallway's middle line.
    const double left = kStart + index * kBay;
    const Brush wall =
        side > 0 ? root_.at({left, kHalf, 0}) : root_.at({left + kBay, -kHalf, 0}).turned(kPi);
    const bool passage = index == (side > 0 ? 8 : 3);
    const bool open = passage || random_.chance(0.25);
    const double half_width = passage ? 1.1 : 0.48;
    const double rise = passage ? 0.25 : 0;
    wall.of(0.7).panel({0, 0, 0}, {kBay, kThick, kHeight}, {half_width, -1, 2.1, rise});
    wall.of(0.7).box({-0.06, kThick, 0}, {0.06, kThick + kRooms, kHeight});  // between rooms
    skirting(wall, half_width);
    if (!open) {
      shut_door(wall);
    } else if (!passage) {
      open_room(wall);
    }
    notice(wall);
  }

  void skirting(const Brush& wall, double half_width) const {
    const double middle = kBay / 2;
    wall.of(0.4).box({0, -0.02, 0}, {middle - half_width - 0.09, 0.01, 0.12});
    wall.of(0.4).box({middle + half_width + 0.09, -0.02, 0}, {kBay, 0.01, 0.12});
    for (const double x : {middle - half_width - 0.09, middle + half_width}) {
      wall.of(0.5).box({x, -0.03, 0}, {x + 0.09, 0.01, 2.1});
    }
  }

  void shut_door(const Brush& wall) const {
    const double middle = kBay / 2;
    wall.of(0.55).box({middle - 0.55, 0.16, 0}, {middle + 0.55, 0.21, 2.15});
    wall.of(0.2).box({middle - 0.2, 0.15, 1.3}, {middle + 0.2, 0.17, 1.85});
    wall.of(0.9).ellipsoid({middle + 0.38, 0.1, 1.03}, {0.07, 0.03, 0.02});
  }

  void open_room(const Brush& wall) {
    const double middle = kBay / 2;
    const double swing = random_.uniform(0.9, 1.7);
    const Brush hinge = wall.at({middle - 0.46, kThick, 0}).turned(swing);
    hinge.of(0.55).box({0, 0, 0.01}, {0.92, 0.045, 2.08});
    table(wall.at({0.6, 3.6, 0}), 1.5, 0.8);
    const double turn = random_.uniform(-0.5, 0.5);
    chair(wall.at({1.3, 3.1, 0}).turned(kPi / 2 + turn));
    bookshelf(wall.at({0.8, kThick + kRooms - 0.4, 0}), random_, 2.2, 1.9);
  }

  void notice(const Brush& wall) {
    const int kind = random_.below(4);
    if (kind == 0) {  // a board with papers
      wall.of(0.5).box({0.3, -0.03, 1.1}, {1.1, 0.01, 1.8});
      wall.of(0.9).box({0.38, -0.035, 1.2}, {0.6, 0.01, 1.5});
      wall.of(0.9).box({0.7, -0.035, 1.4}, {0.95, 0.01, 1.7});
    } else if (kind == 1) {  // a fire extinguisher
      wall.of(0.5).cylinder({0.5, -0.12, 0.75}, {0.5, -0.12, 1.2}, 0.08);
      wall.of(0.5).ellipsoid({0.5, -0.12, 1.2}, {0.08, 0.08, 0.07});
      wall.of(0.2).cylinder({0.5, -0.12, 1.2}, {0.5, -0.12, 1.32}, 0.02);
    } else if (kind == 2) {
      radiator(wall.at({0.25, 0, 0}), 0.9);
    }
  }

  /// Half columns on both walls and a beam under the ceiling; a lamp behind it.
  void frame(double x) const {
    for (const double side : {1.0, -1.0}) {
      root_.of(0.75).cylinder({x, side * kHalf, 0}, {x, side * kHalf, kHeight}, 0.16);
      root_.of(0.6).cylinder({x, side * kHalf, 0}, {x, side * kHalf, 0.2}, 0.2);
    }
    root_.of(0.75).box({x - 0.13, -kHalf, kHeight - 0.24}, {x + 0.13, kHalf, kHeight});
    root_.of(0.95).box({x + 1.3, -0.3, kHeight - 0.07}, {x + 2.7, 0.3, kHeight});
  }

  void ends() const {
    const double width = 2 * kHalf;
    const Brush far = root_.at({kEnd, kHalf, 0}).turned(-kPi / 2);
    far.of(0.7).panel({0, 0, 0}, {width, kThick, kHeight}, {0.7, 0.9, 1.7, 0.5});
    far.of(0.1).box({0, 0.17, 0}, {width, 0.2, kHeight});
    const Brush near = root_.at({kStart, -kHalf, 0}).turned(kPi / 2);
    near.of(0.7).panel({0, 0, 0}, {width, kThick, kHeight}, {0.85, -1, 2.1, 0});
    near.of(0.5).box({0, 0.1, 0}, {width / 2 - 0.01, 0.15, kHeight});
    near.of(0.5).box({width / 2 + 0.01, 0.1, 0}, {width, 0.15, kHeight});
  }

  void things() {
    bench(root_.at({5.6, -0.85, 0}).turned(kPi / 2));
    bench(root_.at({-9.5, 0.85, 0}).turned(-kPi / 2));
    wheelie_bin(root_.at({-4.4, 0.9, 0}).turned(-kPi / 2));
    potted_plant(root_.at({3.4, 0.95, 0}), random_);
    potted_plant(root_.at({14.6, -0.95, 0}), random_);
    const Brush trolley = root_.at({9.3, 0.75, 0}).turned(0.15);
    for (const double z : {0.2, 0.55, 0.9})
      trolley.of(0.6).box({-0.45, -0.25, z}, {0.45, 0.25, z + 0.03});
    for (const double x : {-0.42, 0.42}) {
      for (const double y : {-0.22, 0.22}) {
        trolley.of(0.4).cylinder({x, y, 0.05}, {x, y, 1.0}, 0.016);
        trolley.of(0.1).ellipsoid({x, y, 0.05}, {0.05, 0.02, 0.05});
      }
    }
    const double pace = random_.uniform(0, 1.5);
    person(root_.at({6.5 + pace, 0.35, 0}).turned(kPi), random_);
    person(root_.at({-6.5 - pace, -0.4, 0}), random_);
  }

  Brush root_;
  Random random_;
};

}  // namespace

void draw_corridor(Sketch& sketch, std::uint64_t seed) {
  const Brush root = Brush(sketch).turned(-0.06).at({0, 0.15, -kSensorHeight});
  Corridor(root, seed).draw();
}

}  // namespace curlidar::scenery
