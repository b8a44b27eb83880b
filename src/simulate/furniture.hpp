// SPDX-License-Identifier: BSD-3-Clause
// What stands in rooms. Things stand on z = 0 and face +x unless said.
#pragma once

#include "simulate/random.hpp"
#include "simulate/world.hpp"

namespace curlidar::scenery {

/// A table over [0, length] x [0, width] with legs, 0.75 m high.
void table(const Brush& brush, double length_m, double width_m);
/// Cups, a bowl of fruit, books and a screen on a table's top.
void table_ware(const Brush& brush, Random& random, double length_m, double width_m);
/// A wooden chair centred on the origin; one sits on it looking to +x.
void chair(const Brush& brush);
/// Shelves with books along x from 0 to length, 0.32 m deep towards +y, open to -y.
void bookshelf(const Brush& brush, Random& random, double length_m, double height_m);
/// A sofa along y, 2.1 m long, its seat open to +x.
void sofa(const Brush& brush);
/// A standing lamp with a conical shade.
void floor_lamp(const Brush& brush);
/// A potted plant about 1.2 m high.
void potted_plant(const Brush& brush, Random& random);
/// A ribbed radiator along x from 0 to length, in front of a wall at y = 0, towards -y.
void radiator(const Brush& brush, double length_m);
/// A framed relief of waves and balls on a wall at y = 0, towards -y, its lower left at z = 0.
void wall_relief(const Brush& brush, double length_m, double height_m);
/// A hanging curtain along x from 0 to length, folds of `depth` about y = 0.
void curtain(const Brush& brush, double length_m, double height_m, double depth_m);

}  // namespace curlidar::scenery
