// SPDX-License-Identifier: BSD-3-Clause
// Trees, bushes and hedges. All stand on z = 0 of the brush and grow up.
#pragma once

#include "simulate/random.hpp"
#include "simulate/world.hpp"

namespace curlidar::scenery {

struct TreeStyle {
  double height_m = 7;  ///< to the crown's centre
  double trunk_radius_m = 0.18;
  double crown_radius_m = 2.2;
  double crown_stretch = 1.2;  ///< vertical over horizontal radius of the crown
  int leaves = 260;            ///< clumps of leaves; 0: a bare tree
  int branches = 7;
};

/// A leaning trunk, branches, and a porous crown of small ellipsoids.
void tree(const Brush& brush, Random& random, const TreeStyle& style);
/// A fir: a straight trunk with whorls of drooping branches.
void fir(const Brush& brush, Random& random, double height_m);
/// A low round plant of `leaves` small ellipsoids.
void bush(const Brush& brush, Random& random, double radius_m, int leaves);
/// A clipped hedge along x from 0 to length, centred on y = 0: a core with a rough skin.
void hedge(const Brush& brush, Random& random, double length_m, double height_m);
/// A stretch of upright blades and stalks along x.
void tuft(const Brush& brush, Random& random, double height_m);

}  // namespace curlidar::scenery
