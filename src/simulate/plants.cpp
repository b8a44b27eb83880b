// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/plants.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curlidar::scenery {

namespace {

constexpr double kBark = 0.35;
constexpr double kLeaf = 0.55;

/// A point on the unit sphere.
Vec3 random_direction(Random& random) {
  const double z = random.uniform(-1, 1);
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// A clump of leaves: flat, a little taller or wider than its size.
void leaf_clump(const Brush& brush, Random& random, const Vec3& centre, double size) {
  const Vec3 radii{size * random.uniform(0.7, 1.3), size * random.uniform(0.7, 1.3),
                   size * random.uniform(0.4, 0.9)};
  brush.of(kLeaf + random.uniform(-0.12, 0.12)).ellipsoid(centre, radii);
}

}  // namespace

void tree(const Brush& brush, Random& random, const TreeStyle& style) {
  const Vec3 lean{random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), 1};
  const double radius = style.trunk_radius_m;
  const Brush wood = brush.of(kBark);
  const double fork = style.height_m - 0.5 * style.crown_radius_m * style.crown_stretch;
  const Vec3 crown = lean * style.height_m;
  wood.frustum({0, 0, -0.4}, lean * 0.35, radius * 1.5, radius);  // the flare of the roots
  wood.frustum(lean * 0.35, lean * fork, radius, radius * 0.6);
  wood.frustum(lean * fork, crown, radius * 0.6, radius * 0.2);
  for (int i = 0; i < style.branches; ++i) {
    Vec3 out = random_direction(random);
    out.z = std::abs(out.z) * style.crown_stretch;
    const Vec3 start = lean * random.uniform(0.75 * fork, style.height_m);
    const Vec3 tip = start + out * (style.crown_radius_m * random.uniform(0.6, 0.95));
    wood.frustum(start, tip, radius * 0.35, radius * 0.08);
  }
  for (int i = 0; i < style.leaves; ++i) {
    const Vec3 out = random_direction(random);
    const double reach = style.crown_radius_m * std::cbrt(random.uniform(0.15, 1));
    const Vec3 centre =
        crown + Vec3{out.x * reach, out.y * reach, out.z * reach * style.crown_stretch};
    leaf_clump(brush, random, centre, style.crown_radius_m * random.uniform(0.06, 0.13));
  }
}

void fir(const Brush& brush, Random& random, double height_m) {
  const double radius = 0.018 * height_m + 0.03;
  brush.of(kBark).frustum({0, 0, -0.4}, {0, 0, height_m}, radius, 0.02);
  const int whorls = static_cast<int>(height_m * 1.6);
  for (int i = 0; i < whorls; ++i) {
    const double share = (i + random.uniform(0.2, 0.8)) / whorls;
    const double z = height_m * (0.14 + 0.84 * share);
    const double reach = 0.2 + (1 - share) * 0.2 * height_m * random.uniform(0.7, 1.1);
    const double turn = random.uniform(0, 2 * std::numbers::pi);
    for (int k = 0; k < 6; ++k) {
      const double angle = turn + k * std::numbers::pi / 3 + random.uniform(-0.2, 0.2);
      const double length = reach * random.uniform(0.75, 1.1);
      const Vec3 tip{length * std::cos(angle), length * std::sin(angle), -0.35 * length};
      brush.of(kBark).frustum({0, 0, z}, Vec3{0, 0, z} + tip, 0.03, 0.01);
      for (const double at : {0.45, 0.7, 0.95}) {
        const Brush needles = brush.at(Vec3{0, 0, z} + tip * at).turned(angle);
        needles.of(kLeaf).ellipsoid({}, {0.2 * length, 0.13 * length, 0.05 * length});
      }
    }
  }
}

void bush(const Brush& brush, Random& random, double radius_m, int leaves) {
  for (int i = 0; i < leaves; ++i) {
    Vec3 out = random_direction(random);
    out = out * (radius_m * std::cbrt(random.uniform(0.1, 1)));
    leaf_clump(brush, random, {out.x, out.y, 0.75 * radius_m + 0.8 * out.z},
               radius_m * random.uniform(0.1, 0.22));
  }
}

void hedge(const Brush& brush, Random& random, double length_m, double height_m) {
  const double half = 0.32;
  brush.of(kLeaf).box({0, -half, -0.3}, {length_m, half, height_m});
  const int clumps = static_cast<int>(length_m * 14);
  for (int i = 0; i < clumps; ++i) {
    const double x = random.uniform(0, length_m);
    const double z = random.uniform(0.1, height_m);
    const bool on_top = random.chance(0.35);
    const double side = random.chance(0.5) ? half : -half;
    const Vec3 centre = on_top ? Vec3{x, side * random.uniform(-1, 1), height_m} : Vec3{x, side, z};
    leaf_clump(brush, random, centre, random.uniform(0.06, 0.16));
  }
}

void tuft(const Brush& brush, Random& random, double height_m) {
  for (int i = 0; i < 9; ++i) {
    const Vec3 foot{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), -0.05};
    const Vec3 bend{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 1};
    brush.of(kLeaf).frustum(foot, foot + bend * (height_m * random.uniform(0.6, 1)), 0.012, 0.003);
  }
}

}  // namespace curlidar::scenery
