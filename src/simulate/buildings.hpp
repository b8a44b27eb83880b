// SPDX-License-Identifier: BSD-3-Clause
// Walls with openings, houses, arcades.
#pragma once

#include "simulate/random.hpp"
#include "simulate/world.hpp"

namespace curlidar::scenery {

struct HouseStyle {
  double length_m = 12, depth_m = 10;
  int storeys = 3;
  double storey_m = 3.0;
  double bay_m = 2.8;     ///< width of a window's share of the wall, about
  bool gable = true;      ///< ridge along x; otherwise a flat roof with a parapet
  double plinth_m = 0.5;  ///< height of a foot that stands 6 cm out
};

/// A house whose front lies along x from 0 to length at y = 0 and looks to -y; its body reaches
/// to y = depth. The front has a door, windows with recesses and sills, and a cornice.
void house(const Brush& brush, Random& random, const HouseStyle& style);

/// A wall of `thickness` along x from 0 to length between two heights, with equal round arches
/// over openings of a share of the bay, on piers. `bays` at least 1.
struct ArcadeStyle {
  double length_m = 30, height_m = 4.2, thickness_m = 0.6;
  int bays = 8;
  double open_share = 0.68;
  double spring_m = 2.4;  ///< height where the arches begin
};
void arcade(const Brush& brush, const ArcadeStyle& style);

/// A wall along x from 0 to length at y in [0, thickness] with one row of equal windows.
struct WindowRow {
  double length_m = 30, low_m = 4.2, high_m = 8, thickness_m = 0.4;
  int bays = 10;
  double width_m = 1.1, sill_m = 1.0, head_m = 2.4;  ///< above `low`
  double rise_m = 0;                                 ///< of a round head above head_m
};
void window_row(const Brush& brush, const WindowRow& row);

/// A closed gabled roof over [0, length] x [0, depth] at height z, ridge along x.
void gable_roof(const Brush& brush, double length_m, double depth_m, double z, double rise_m);

}  // namespace curlidar::scenery
