// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/furniture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/plants.hpp"

namespace curlidar::scenery {

void table(const Brush& brush, double length_m, double width_m) {
  const Brush wood = brush.of(0.55);
  wood.box({0, 0, 0.71}, {length_m, width_m, 0.75});
  wood.box({0.1, 0.08, 0.6}, {length_m - 0.1, width_m - 0.08, 0.71});
  for (const double x : {0.06, length_m - 0.06}) {
    for (const double y : {0.06, width_m - 0.06}) {
      wood.frustum({x, y, 0.71}, {x, y, 0}, 0.04, 0.025);
    }
  }
}

void table_ware(const Brush& brush, Random& random, double length_m, double width_m) {
  const Brush china = brush.of(0.85);
  for (int i = 0; i < 5; ++i) {
    const Vec3 foot{random.uniform(0.1, length_m - 0.1), random.uniform(0.1, 0.35 * width_m), 0.75};
    china.frustum(foot + Vec3{0, 0, 0.1}, foot, 0.045, 0.03);
  }
  const Vec3 bowl{length_m * 0.45, width_m * 0.5, 0.75};
  china.frustum(bowl + Vec3{0, 0, 0.09}, bowl, 0.17, 0.08);
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3;
    brush.of(0.5).ellipsoid(bowl + Vec3{0.08 * std::cos(angle), 0.08 * std::sin(angle), 0.12},
                            {0.045, 0.045, 0.04});
  }
  double z = 0.75;
  for (int i = 0; i < 4; ++i) {
    const double thickness = random.uniform(0.02, 0.05);
    const Brush book =
        brush.at({length_m * 0.78, width_m * 0.62, z}).turned(random.uniform(-0.4, 0.4));
    book.of(random.uniform(0.2, 0.8)).box({-0.12, -0.09, 0}, {0.12, 0.09, thickness});
    z += thickness;
  }
  const Brush screen = brush.at({length_m * 0.18, width_m * 0.72, 0.75}).turned(0.3);
  screen.of(0.1).box({-0.28, -0.015, 0.12}, {0.28, 0.015, 0.48});
  screen.of(0.2).cylinder({0, 0.04, 0}, {0, 0.03, 0.3}, 0.02);
  screen.of(0.2).cylinder({0, 0.03, 0}, {0, 0.03, 0.015}, 0.12);
}

void chair(const Brush& brush) {
  const Brush wood = brush.of(0.5);
  wood.box({-0.21, -0.22, 0.43}, {0.22, 0.22, 0.47});
  for (const double y : {-0.19, 0.19}) {
    wood.cylinder({0.19, y, 0}, {0.19, y, 0.43}, 0.018);
    wood.cylinder({-0.2, y, 0}, {-0.2, y, 0.45}, 0.02);
    wood.cylinder({-0.2, y, 0.45}, {-0.28, y, 0.95}, 0.02);
  }
  for (const double share : {0.35, 0.65, 0.95}) {
    const double x = -0.2 - 0.08 * share;
    wood.box({x - 0.012, -0.19, 0.42 + 0.5 * share}, {x + 0.012, 0.19, 0.49 + 0.5 * share});
  }
}

void bookshelf(const Brush& brush, Random& random, double length_m, double height_m) {
  const Brush wood = brush.of(0.5);
  const double depth = 0.32;
  wood.box({0, depth - 0.015, 0}, {length_m, depth, height_m});
  for (const double x : {0.0, length_m / 2 - 0.01, length_m - 0.02}) {
    wood.box({x, 0, 0}, {x + 0.02, depth, height_m});
  }
  const int boards = std::max(2, static_cast<int>(height_m / 0.36));
  for (int i = 0; i <= boards; ++i) {
    const double z = (height_m - 0.02) * i / boards;
    wood.box({0, 0, z}, {length_m, depth, z + 0.02});
    if (i == boards) break;
    double x = 0.04 + random.uniform(0, 0.1);
    while (x < length_m - 0.1) {
      const double thickness = random.uniform(0.02, 0.06);
      const double tall = random.uniform(0.19, 0.29);
      const double front = random.uniform(0.03, 0.12);
      brush.of(random.uniform(0.15, 0.85))
          .box({x, front, z + 0.02}, {x + thickness, 0.28, z + 0.02 + tall});
      x += thickness + (random.chance(0.12) ? random.uniform(0.08, 0.25) : 0.004);
    }
  }
}

void sofa(const Brush& brush) {
  const Brush cloth = brush.of(0.4);
  cloth.box({-0.42, -0.95, 0.12}, {0.42, 0.95, 0.36});
  cloth.box({-0.45, -1.05, 0.12}, {-0.2, 1.05, 0.72});
  cloth.cylinder({-0.33, -1.05, 0.72}, {-0.33, 1.05, 0.72}, 0.125);
  for (const double side : {1.0, -1.0}) {
    cloth.box({-0.42, side * 1.0 - 0.1, 0.1}, {0.42, side * 1.0 + 0.1, 0.54});
    cloth.cylinder({-0.42, side * 1.0, 0.54}, {0.43, side * 1.0, 0.54}, 0.115);
    cloth.ellipsoid({0.1, side * 0.45, 0.4}, {0.36, 0.45, 0.1});      // seat cushions
    cloth.ellipsoid({-0.12, side * 0.45, 0.66}, {0.13, 0.42, 0.22});  // back cushions
  }
}

void floor_lamp(const Brush& brush) {
  brush.of(0.4).cylinder({0, 0, 0}, {0, 0, 0.03}, 0.15);
  brush.of(0.4).cylinder({0, 0, 0.03}, {0, 0, 1.5}, 0.015);
  brush.of(0.8).frustum({0, 0, 1.35}, {0, 0, 1.68}, 0.24, 0.14);
}

void potted_plant(const Brush& brush, Random& random) {
  brush.of(0.45).frustum({0, 0, 0.35}, {0, 0, 0}, 0.2, 0.14);
  brush.of(0.35).cylinder({0, 0, 0.3}, {0, 0, 0.75}, 0.02);
  bush(brush.at({0, 0, 0.55}), random, 0.36, 70);
}

void radiator(const Brush& brush, double length_m) {
  const Brush steel = brush.of(0.8);
  const int ribs = static_cast<int>(length_m / 0.08);
  for (int i = 0; i < ribs; ++i) {
    const double x = (i + 0.5) * length_m / ribs;
    steel.cylinder({x, -0.09, 0.14}, {x, -0.09, 0.7}, 0.026);
  }
  steel.cylinder({0, -0.09, 0.16}, {length_m, -0.09, 0.16}, 0.03);
  steel.cylinder({0, -0.09, 0.68}, {length_m, -0.09, 0.68}, 0.03);
}

void wall_relief(const Brush& brush, double length_m, double height_m) {
  const Brush frame = brush.of(0.4);
  const Brush plaster = brush.of(0.85);
  frame.box({0, -0.06, 0}, {length_m, 0, 0.06});
  frame.box({0, -0.06, height_m - 0.06}, {length_m, 0, height_m});
  frame.box({0, -0.06, 0}, {0.06, 0, height_m});
  frame.box({length_m - 0.06, -0.06, 0}, {length_m, 0, height_m});
  constexpr int kRows = 24, kColumns = 36;
  plaster.sheet(kRows, kColumns, [&](int i, int j) {
    const double u = static_cast<double>(j) / (kColumns - 1);
    const double v = static_cast<double>(i) / (kRows - 1);
    const double wave =
        std::sin(2 * std::numbers::pi * (1.5 * u + 0.5 * v)) * std::sin(std::numbers::pi * v);
    return Vec3{u * length_m, -0.03 - 0.025 * wave, v * height_m};
  });
  plaster.ellipsoid({0.3 * length_m, -0.04, 0.6 * height_m}, {0.14, 0.09, 0.14});
  plaster.ellipsoid({0.7 * length_m, -0.04, 0.4 * height_m}, {0.2, 0.1, 0.12});
}

void curtain(const Brush& brush, double length_m, double height_m, double depth_m) {
  const int columns = std::max(8, static_cast<int>(length_m * 50));
  brush.of(0.6).sheet(2, columns, [&](int i, int j) {
    const double x = length_m * j / (columns - 1);
    const double fold = std::sin(2 * std::numbers::pi * x / 0.16) + 0.4 * std::sin(x * 23);
    return Vec3{x, depth_m * fold * (i == 0 ? 1 : 0.7), i * height_m};
  });
  brush.of(0.5).cylinder({-0.1, 0, height_m + 0.03}, {length_m + 0.1, 0, height_m + 0.03}, 0.015);
}

}  // namespace curlidar::scenery
