// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/buildings.hpp"

#include <algorithm>
#include <cmath>

namespace curlidar::scenery {

namespace {

constexpr double kWall = 0.35;    // thickness of a house's front
constexpr double kRecess = 0.24;  // from the front to the glass
constexpr double kGlass = 0.12;

/// One bay of a front: a panel with a window or a door, and what stands out from it.
void bay(const Brush& wall, const Brush& trim, double left, double right, double low, double high,
         const Opening& opening) {
  wall.panel({left, 0, low}, {right, kWall, high}, opening);
  const double middle = (left + right) / 2;
  const bool door = opening.bottom <= low;
  if (door) {
    trim.box({middle - opening.half_width - 0.1, -0.35, low},
             {middle + opening.half_width + 0.1, 0, 0.16});
    trim.box({middle - opening.half_width - 0.3, -0.7, opening.spring + 0.15},
             {middle + opening.half_width + 0.3, 0, opening.spring + 0.27});
    trim.ellipsoid({middle + opening.half_width - 0.12, kRecess - 0.04, 1.1}, {0.04, 0.05, 0.04});
    return;
  }
  trim.box({middle - opening.half_width - 0.08, -0.1, opening.bottom - 0.09},
           {middle + opening.half_width + 0.08, 0.05, opening.bottom});
  trim.box({middle - 0.03, kRecess - 0.06, opening.bottom},
           {middle + 0.03, kRecess, opening.spring + opening.rise});  // the mullion
}

}  // namespace

void gable_roof(const Brush& brush, double length_m, double depth_m, double z, double rise_m) {
  const double eaves = 0.35;
  const double y0 = -eaves, y1 = depth_m + eaves, ridge = depth_m / 2;
  const double low = z - rise_m * eaves / ridge;
  const Vec3 a{0, y0, low}, b{length_m, y0, low}, c{length_m, ridge, z + rise_m};
  const Vec3 d{0, ridge, z + rise_m}, e{0, y1, low}, f{length_m, y1, low};
  brush.quad(a, b, c, d);
  brush.quad(d, c, f, e);
  brush.quad(a, b, f, e);
  brush.triangle(a, d, e);
  brush.triangle(b, c, f);
}

void house(const Brush& brush, Random& random, const HouseStyle& style) {
  const double length = style.length_m;
  const double top = style.storeys * style.storey_m + 0.4;
  const Brush wall = brush.of(random.uniform(0.3, 0.75));
  const Brush trim = brush.of(random.uniform(0.5, 0.8));
  const int bays = std::max(2, static_cast<int>(std::lround(length / style.bay_m)));
  const int door = random.below(bays);
  const double half_width = length / bays * random.uniform(0.19, 0.26);
  const double rise = random.chance(0.4) ? half_width * 0.45 : 0;
  for (int storey = 0; storey < style.storeys; ++storey) {
    const double low = storey == 0 ? -1 : storey * style.storey_m + 0.4;
    const double high = (storey + 1) * style.storey_m + 0.4;
    for (int i = 0; i < bays; ++i) {
      const double left = length * i / bays, right = length * (i + 1) / bays;
      if (storey == 0 && i == door) {
        bay(wall, trim, left, right, low, high, {0.55, -1, 2.25, rise});
      } else {
        const double sill = high - style.storey_m + (storey == 0 ? 0.75 : 0.85);
        bay(wall, trim, left, right, low, high, {half_width, sill, high - 0.75, rise});
      }
    }
  }
  // The body behind the front shows through the openings as glass and doors.
  brush.of(kGlass).box({0.02, kRecess, -1}, {length - 0.02, style.depth_m - 0.02, top});
  wall.box({0, kWall, -1}, {0.3, style.depth_m, top});
  wall.box({length - 0.3, kWall, -1}, {length, style.depth_m, top});
  wall.box({0, style.depth_m - 0.3, -1}, {length, style.depth_m, top});
  trim.box({0, -0.06, -1}, {length / bays * door + length / bays / 2 - 0.65, 0.05, style.plinth_m});
  trim.box({length / bays * door + length / bays / 2 + 0.65, -0.06, -1},
           {length, 0.05, style.plinth_m});
  trim.box({-0.02, -0.12, style.storey_m + 0.3}, {length + 0.02, 0.05, style.storey_m + 0.48});
  trim.box({-0.05, -0.25, top - 0.2}, {length + 0.05, 0.1, top});
  const double pipe = random.chance(0.5) ? 0.25 : length - 0.25;
  trim.cylinder({pipe, -0.1, -0.5}, {pipe, -0.1, top - 0.2}, 0.055);
  if (style.gable) {
    gable_roof(brush.of(0.35), length, style.depth_m, top, 0.36 * style.depth_m);
    const double chimney = random.uniform(0.2, 0.8) * length;
    const double y = style.depth_m * 0.6;
    brush.of(0.4).box({chimney, y, top},
                      {chimney + 0.9, y + 0.6, top + 0.36 * style.depth_m + 0.9});
  } else {
    wall.box({0, 0, top}, {length, 0.3, top + 0.9});
  }
}

void arcade(const Brush& brush, const ArcadeStyle& style) {
  const double pitch = style.length_m / style.bays;
  const double half_width = style.open_share * pitch / 2;
  const Brush trim = brush.of(0.7);
  for (int i = 0; i < style.bays; ++i) {
    const double left = i * pitch;
    brush.panel({left, 0, -1}, {left + pitch, style.thickness_m, style.height_m},
                {half_width, -1, style.spring_m, half_width});
    // Half columns on the piers, with foot and capital.
    const Vec3 pier{left, 0, 0};
    trim.cylinder(pier, pier + Vec3{0, 0, style.height_m - 0.3}, 0.16);
    trim.box(pier + Vec3{-0.24, -0.24, -0.5}, pier + Vec3{0.24, 0.1, 0.3});
    trim.box(pier + Vec3{-0.22, -0.22, style.spring_m - 0.2},
             pier + Vec3{0.22, 0.1, style.spring_m});
  }
  trim.box({0, -0.14, style.height_m - 0.3}, {style.length_m, 0.1, style.height_m});
}

void window_row(const Brush& brush, const WindowRow& row) {
  const double pitch = row.length_m / row.bays;
  const Brush trim = brush.of(0.7);
  const double recess = 0.6 * row.thickness_m;
  for (int i = 0; i < row.bays; ++i) {
    const double left = i * pitch, middle = left + pitch / 2, half = row.width_m / 2;
    const double sill = row.low_m + row.sill_m, head = row.low_m + row.head_m;
    brush.panel({left, 0, row.low_m}, {left + pitch, row.thickness_m, row.high_m},
                {half, sill, head, row.rise_m});
    trim.box({middle - half - 0.08, -0.1, sill - 0.1}, {middle + half + 0.08, 0.05, sill});
    trim.box({middle - 0.04, recess - 0.08, sill}, {middle + 0.04, recess, head + row.rise_m});
    trim.box({middle - half, recess - 0.07, (sill + head) / 2 - 0.03},
             {middle + half, recess, (sill + head) / 2 + 0.03});
  }
  brush.of(kGlass).box({0, recess, row.low_m}, {row.length_m, row.thickness_m - 0.02, row.high_m});
}

}  // namespace curlidar::scenery
