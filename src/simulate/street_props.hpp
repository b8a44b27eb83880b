// SPDX-License-Identifier: BSD-3-Clause
// What stands in streets and gardens. Things stand on z = 0, face +x and are centred unless said.
#pragma once

#include "simulate/random.hpp"
#include "simulate/world.hpp"

namespace curlidar::scenery {

/// A saloon, hatchback, estate, van or off-roader, 3.8 to 5.2 m long.
void car(const Brush& brush, Random& random);
/// A walker in mid step.
void person(const Brush& brush, Random& random);
/// A bicycle leaning on its stand.
void bicycle(const Brush& brush);
/// A street lamp whose arm reaches 1.6 m towards +x.
void lamp_post(const Brush& brush, double height_m);
/// A traffic sign: a disc or a triangle's place-holder plate on a pole.
void sign(const Brush& brush, Random& random);
void bollard(const Brush& brush);
/// A wheeled bin with a lid.
void wheelie_bin(const Brush& brush);
/// A park bench with a back, 1.6 m long across y.
void bench(const Brush& brush);
/// Posts and rails along x from 0 to length.
void fence(const Brush& brush, double length_m, double height_m);

}  // namespace curlidar::scenery
