// SPDX-License-Identifier: BSD-3-Clause
// The built-in worlds, each drawn around a sensor at the origin.
#pragma once

#include <cstdint>

#include "simulate/world.hpp"

namespace curlidar::scenery {

/// A street with parked cars, houses and trees; the sensor on a car, 1.73 m above the road.
void draw_street(Sketch& sketch, std::uint64_t seed);
/// A furnished living room, 6.2 x 5 m; the sensor at 1.15 m.
void draw_room(Sketch& sketch, std::uint64_t seed);
/// Uneven ground under broad-leaved trees and firs; the sensor at 1.5 m.
void draw_forest(Sketch& sketch, std::uint64_t seed);
/// A hallway of 60 m with doors, some open to rooms; the sensor at 1.2 m.
void draw_corridor(Sketch& sketch, std::uint64_t seed);
/// A college quadrangle of 56 x 48 m with arcades, lawn and trees; the sensor in a hand at 1.5 m.
void draw_college(Sketch& sketch, std::uint64_t seed);

}  // namespace curlidar::scenery
