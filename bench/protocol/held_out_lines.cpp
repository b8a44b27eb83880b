// SPDX-License-Identifier: BSD-3-Clause
#include "protocol/held_out_lines.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include "curlidar/lattice.hpp"

namespace curlidar::bench {
namespace {

/// Where a beam that looks along an azimuth passes the spin axis.
Vec3 start_of(const Beam& beam, double azimuth) {
  return {-beam.lateral_m * std::sin(azimuth), beam.lateral_m * std::cos(azimuth), beam.height_m};
}

/// Where the beam that hits a point passes the spin axis.
Vec3 start_towards(const Beam& beam, const Vec3& point) {
  const auto view = view_along(beam, point);
  return view ? start_of(beam, view->encoder + beam.azimuth_offset) : Vec3{};
}

}  // namespace

AskedLines lines_of(const RingSplit& split, const BeamModel* beams) {
  AskedLines asked;
  for (std::size_t i = 0; i < split.held_out.size(); ++i) {
    const Vec3& p = split.held_out[i];
    const Vec3 start = beams ? start_towards(beams->beams[split.held_out_ring[i]], p) : Vec3{};
    const double range_m = norm(p - start);
    asked.lines.push_back({start, (p - start) * (1 / range_m)});
    asked.true_m.push_back(range_m);
  }
  for (std::size_t i = 0; i < split.gaps.size(); ++i) {
    const double azimuth = azimuth_of(split.gaps[i]);
    const Beam* beam = beams ? &beams->beams[split.gap_ring[i]] : nullptr;
    asked.lines.push_back(
        beam ? Sightline{start_of(*beam, azimuth), direction_of(beam->elevation, azimuth)}
             : Sightline{{}, split.gaps[i]});
    asked.true_m.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  return asked;
}

}  // namespace curlidar::bench
