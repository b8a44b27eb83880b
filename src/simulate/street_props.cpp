// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/street_props.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace curlidar::scenery {

namespace {

/// A point of a car's silhouette seen from its left, and the car's half width there.
struct Station {
  double x, z, half_width;
};

/// A car's outline, from the rear bumper over the roof to the front, for a length of 1 and true
/// heights; the bumpers stand at x = -0.5 and 0.5.
struct CarModel {
  double length, width;
  std::vector<Station> outline;
};

const std::vector<CarModel>& car_models() {
  static const std::vector<CarModel> models = {{4.6,
                                                1.80,  // saloon
                                                {{-.49, .28, .90},
                                                 {-.50, .55, .95},
                                                 {-.49, .88, .93},
                                                 {-.46, 1.00, .90},
                                                 {-.34, 1.04, .88},
                                                 {-.22, 1.36, .70},
                                                 {-.10, 1.45, .66},
                                                 {.06, 1.42, .67},
                                                 {.22, .98, .88},
                                                 {.36, .92, .90},
                                                 {.46, .78, .88},
                                                 {.50, .55, .84},
                                                 {.49, .26, .82}}},
                                               {4.0,
                                                1.74,  // hatchback
                                                {{-.49, .30, .90},
                                                 {-.50, .58, .95},
                                                 {-.49, .95, .92},
                                                 {-.43, 1.32, .76},
                                                 {-.36, 1.47, .70},
                                                 {-.08, 1.52, .70},
                                                 {.10, 1.44, .72},
                                                 {.27, 1.02, .88},
                                                 {.40, .93, .90},
                                                 {.48, .76, .87},
                                                 {.50, .52, .84},
                                                 {.49, .26, .82}}},
                                               {4.7,
                                                1.84,  // estate
                                                {{-.49, .30, .90},
                                                 {-.50, .60, .95},
                                                 {-.49, 1.00, .92},
                                                 {-.45, 1.42, .74},
                                                 {-.38, 1.50, .70},
                                                 {.02, 1.50, .70},
                                                 {.10, 1.45, .72},
                                                 {.25, 1.00, .89},
                                                 {.38, .94, .91},
                                                 {.47, .80, .88},
                                                 {.50, .55, .84},
                                                 {.49, .26, .82}}},
                                               {5.2,
                                                1.98,  // van
                                                {{-.49, .34, .94},
                                                 {-.50, .70, .98},
                                                 {-.50, 1.80, .92},
                                                 {-.49, 1.96, .86},
                                                 {-.40, 2.02, .82},
                                                 {.18, 2.00, .82},
                                                 {.26, 1.90, .84},
                                                 {.38, 1.22, .93},
                                                 {.47, 1.02, .92},
                                                 {.50, .70, .90},
                                                 {.49, .30, .86}}},
                                               {4.5,
                                                1.90,  // off-roader
                                                {{-.49, .40, .92},
                                                 {-.50, .70, .97},
                                                 {-.49, 1.10, .94},
                                                 {-.45, 1.58, .80},
                                                 {-.38, 1.70, .74},
                                                 {.04, 1.72, .74},
                                                 {.12, 1.66, .76},
                                                 {.24, 1.16, .92},
                                                 {.40, 1.08, .93},
                                                 {.48, .92, .90},
                                                 {.50, .62, .87},
                                                 {.49, .36, .85}}}};
  return models;
}

/// A body that bulges from the side's middle to the outline, closed all round.
void car_body(const Brush& paint, const CarModel& model) {
  const double half = model.width / 2;
  const auto point = [&](const Station& s, double side) {
    return Vec3{s.x * model.length, side * s.half_width * half, s.z};
  };
  const auto& outline = model.outline;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Station& a = outline[i];
    const Station& b = outline[(i + 1) % outline.size()];
    paint.quad(point(a, 1), point(b, 1), point(b, -1), point(a, -1));
    for (const double side : {1.0, -1.0}) {
      paint.triangle({0.02 * model.length, side * half, 0.72}, point(a, side), point(b, side));
    }
  }
}

void wheels(const Brush& brush, const CarModel& model) {
  const Brush rubber = brush.of(0.08);
  const Brush rim = brush.of(0.7);
  for (const double x : {-0.31, 0.33}) {
    for (const double side : {1.0, -1.0}) {
      const double y = side * model.width / 2;
      const Vec3 hub{x * model.length, y, 0.32};
      rubber.cylinder(hub - Vec3{0, side * 0.22, 0}, hub, 0.32);
      rim.cylinder(hub - Vec3{0, side * 0.1, 0}, hub + Vec3{0, side * 0.02, 0}, 0.2);
    }
  }
}

}  // namespace

void car(const Brush& brush, Random& random) {
  const auto& models = car_models();
  const CarModel& model =
      models[static_cast<std::size_t>(random.below(static_cast<int>(models.size())))];
  const double paint = random.uniform(0.15, 0.9);
  car_body(brush.of(paint), model);
  wheels(brush, model);
  for (const double side : {1.0, -1.0}) {  // mirrors
    brush.of(paint).ellipsoid({0.19 * model.length, side * (model.width / 2 + 0.02), 1.02},
                              {0.08, 0.13, 0.08});
  }
  const Brush plate = brush.of(0.95);
  plate.box({-0.505 * model.length, -0.26, 0.58}, {-0.49 * model.length, 0.26, 0.69});
  plate.box({0.48 * model.length, -0.26, 0.45}, {0.505 * model.length, 0.26, 0.56});
}

void person(const Brush& brush, Random& random) {
  const double scale = random.uniform(0.9, 1.06);
  const double step = random.uniform(0.08, 0.3);
  const Brush body = brush.in({{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, {}});
  const Brush trousers = body.of(random.uniform(0.1, 0.6));
  const Brush coat = body.of(random.uniform(0.1, 0.8));
  const Brush skin = body.of(0.6);
  for (const double side : {1.0, -1.0}) {
    const double swing = side * step;
    const Vec3 hip{0, side * 0.09, 0.88}, knee{swing * 0.6, side * 0.1, 0.48};
    const Vec3 foot{swing, side * 0.1, 0.06};
    trousers.frustum(hip, knee, 0.095, 0.065);
    trousers.frustum(knee, foot, 0.065, 0.045);
    trousers.ellipsoid(foot + Vec3{0.07, 0, -0.01}, {0.14, 0.05, 0.05});
    const Vec3 shoulder{0, side * 0.2, 1.42}, elbow{-swing * 0.5, side * 0.26, 1.14};
    coat.frustum(shoulder, elbow, 0.06, 0.045);
    coat.frustum(elbow, {-swing * 0.5 + 0.12, side * 0.24, 0.92}, 0.045, 0.035);
  }
  coat.ellipsoid({0, 0, 1.18}, {0.14, 0.2, 0.34});
  coat.ellipsoid({0, 0, 1.4}, {0.11, 0.23, 0.1});
  skin.cylinder({0, 0, 1.45}, {0.01, 0, 1.58}, 0.055);
  skin.ellipsoid({0.02, 0, 1.66}, {0.1, 0.08, 0.12});
}

void bicycle(const Brush& brush) {
  const Brush tyre = brush.of(0.1);
  const Brush frame = brush.of(0.6);
  constexpr int kParts = 14;
  for (const double hub_x : {-0.52, 0.52}) {
    for (int i = 0; i < kParts; ++i) {
      const auto rim = [&](int k) {
        const double angle = 2 * std::numbers::pi * k / kParts;
        return Vec3{hub_x + 0.33 * std::cos(angle), 0, 0.34 + 0.33 * std::sin(angle)};
      };
      tyre.cylinder(rim(i), rim(i + 1), 0.02);
      if (i % 2 == 0) frame.cylinder({hub_x, 0, 0.34}, rim(i), 0.004);
    }
  }
  const Vec3 saddle{-0.25, 0, 0.95}, crank{-0.08, 0, 0.3}, head{0.35, 0, 0.85};
  frame.cylinder({-0.52, 0, 0.34}, crank, 0.012);
  frame.cylinder({-0.52, 0, 0.34}, saddle - Vec3{-0.06, 0, 0.2}, 0.012);
  frame.cylinder(crank, saddle, 0.018);
  frame.cylinder(crank, head, 0.02);
  frame.cylinder(saddle - Vec3{-0.06, 0, 0.2}, head, 0.018);
  frame.cylinder({0.52, 0, 0.34}, {0.32, 0, 1.0}, 0.016);
  frame.cylinder({0.32, -0.27, 1.02}, {0.32, 0.27, 1.02}, 0.014);
  tyre.ellipsoid(saddle, {0.14, 0.07, 0.035});
}

void lamp_post(const Brush& brush, double height_m) {
  const Brush steel = brush.of(0.5);
  steel.cylinder({0, 0, -0.3}, {0, 0, 1.1}, 0.1);
  steel.frustum({0, 0, 1.1}, {0, 0, height_m}, 0.08, 0.045);
  steel.cylinder({0, 0, height_m}, {1.6, 0, height_m + 0.25}, 0.035);
  steel.box({1.2, -0.12, height_m + 0.13}, {1.85, 0.12, height_m + 0.28});
}

void sign(const Brush& brush, Random& random) {
  brush.of(0.5).cylinder({0, 0, -0.3}, {0, 0, 2.9}, 0.035);
  const Brush face = brush.of(0.98);
  if (random.chance(0.5)) {
    face.cylinder({0.03, 0, 2.55}, {0.05, 0, 2.55}, 0.32);
  } else {
    face.box({0.03, -0.3, 2.2}, {0.05, 0.3, 2.85});
  }
}

void bollard(const Brush& brush) {
  const Brush iron = brush.of(0.3);
  iron.frustum({0, 0, -0.2}, {0, 0, 0.85}, 0.08, 0.06);
  iron.ellipsoid({0, 0, 0.88}, {0.075, 0.075, 0.07});
}

void wheelie_bin(const Brush& brush) {
  const Brush plastic = brush.of(0.25);
  plastic.box({-0.24, -0.25, 0.12}, {0.24, 0.25, 0.98});
  plastic.box({-0.29, -0.28, 0.98}, {0.3, 0.28, 1.06});
  for (const double side : {1.0, -1.0}) {
    plastic.cylinder({-0.2, side * 0.22, 0.1}, {-0.2, side * 0.28, 0.1}, 0.1);
  }
}

void bench(const Brush& brush) {
  const Brush wood = brush.of(0.45);
  const Brush iron = brush.of(0.3);
  for (int i = 0; i < 4; ++i) {
    const double x = -0.18 + 0.12 * i;
    wood.box({x, -0.8, 0.43}, {x + 0.1, 0.8, 0.46});
  }
  for (int i = 0; i < 3; ++i) {
    const double z = 0.56 + 0.14 * i;
    wood.box({-0.27 - 0.02 * i, -0.8, z}, {-0.24 - 0.02 * i, 0.8, z + 0.1});
  }
  for (const double y : {-0.7, 0.0, 0.7}) {
    iron.box({-0.24, y - 0.03, 0.38}, {0.28, y + 0.03, 0.43});
    iron.box({0.2, y - 0.03, -0.1}, {0.26, y + 0.03, 0.4});
    iron.cylinder({-0.2, y, -0.1}, {-0.3, y, 0.95}, 0.03);
  }
}

void fence(const Brush& brush, double length_m, double height_m) {
  const Brush wood = brush.of(0.5);
  const int posts = std::max(1, static_cast<int>(length_m / 2.0));
  for (int i = 0; i <= posts; ++i) {
    const double x = length_m * i / posts;
    wood.box({x - 0.05, -0.05, -0.3}, {x + 0.05, 0.05, height_m + 0.1});
  }
  for (const double share : {0.3, 0.85}) {
    wood.box({0, -0.02, share * height_m - 0.04}, {length_m, 0.02, share * height_m + 0.04});
  }
  const int slats = static_cast<int>(length_m / 0.16);
  for (int i = 0; i < slats; ++i) {
    const double x = (i + 0.5) * length_m / slats;
    wood.box({x - 0.045, 0.02, 0.08}, {x + 0.045, 0.045, height_m});
  }
}

}  // namespace curlidar::scenery
