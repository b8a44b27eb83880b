// SPDX-License-Identifier: BSD-3-Clause
// A block of houses and the street around it, in the frame of a map: x and y level, z up.
#pragma once

#include <cstdint>

#include "simulate/world.hpp"

namespace curlidar::scenery {

/// A place on the street around the block, and how it lies there.
struct StreetPlace {
  Vec3 position{};  ///< on the ground
  double yaw = 0;   ///< along the street, radians
};

/// Length of the street's middle, once around.
double block_lap_m();
/// `along` metres from the start (any number; laps repeat), `left` metres beside the middle.
StreetPlace block_street(double along, double left);
/// Height of the ground where nothing is paved.
double block_ground(double x, double y);
/// Everything that stands still.
void draw_block(Sketch& sketch, std::uint64_t seed);
/// What moves, at a moment, and is nearer than `reach_m` to a place.
void draw_traffic(Sketch& sketch, std::uint64_t seed, double time_s, const Vec3& near,
                  double reach_m);

}  // namespace curlidar::scenery
