// SPDX-License-Identifier: BSD-3-Clause
// The lines of sight of rings that were held out, and what is true along them.
#pragma once

#include <vector>

#include "curlidar/field.hpp"
#include "protocol/ring_split.hpp"
#include "sensor/lattice.hpp"

namespace curlidar::bench {

struct AskedLines {
  std::vector<Sightline> lines;  ///< directions of length 1
  std::vector<double> true_m;    ///< along the line; NaN in gaps
};

/// Those of the held-out returns, then those of the gaps. They start where the beam of their ring
/// passes the spin axis, if the beams are known, or else at the origin.
AskedLines lines_of(const RingSplit& split, const BeamModel* beams);

}  // namespace curlidar::bench
