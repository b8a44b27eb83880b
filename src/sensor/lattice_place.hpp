// SPDX-License-Identifier: BSD-3-Clause
// From returns seen along their beams to firings, and to a cell of its own for each return.
#pragma once

#include <cstdint>
#include <vector>

#include "sensor/lattice.hpp"

namespace curlidar {

/// A return as one beam may have seen it; a return may have several of these.
struct Sighting {
  std::uint32_t slot = 0;  ///< of the cloud
  std::uint16_t ring = 0;
  double encoder = 0;     ///< in steps, [0, slots)
  double up_m = 0;        ///< from the cone of the beam
  double distance_m = 0;  ///< metres a radian of encoder
  double range_m = 0;
  double s = 0;  ///< of a turn, at which the motion was undone; [-0.5, 0.5] or hardly more
};

struct Placement {
  std::vector<std::uint32_t> firings;  ///< encoder positions, ascending
  struct Place {
    std::uint32_t sighting = 0;  ///< index into the sightings
    std::uint32_t firing = 0;    ///< index into `firings`
    double across_m = 0;
  };
  std::vector<Place> places;  ///< at most one a cell and a return
  /// Returns within the tolerance of a ray whose places others took: second returns, mostly.
  std::size_t sharing = 0;
};

/// Encoder positions at which lasers fired, as few as explain the returns, and who is where. A
/// return within tolerance_m of a ray comes before those within reach_m; clearly nearer ones first,
/// then in the order of the sightings.
Placement place_returns(const std::vector<Sighting>& sightings, const BeamModel& model,
                        double tolerance_m, double reach_m);

}  // namespace curlidar
