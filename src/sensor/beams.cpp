// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/beams.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curlidar {

Beams::Beams(const SensorProfile& profile) : radius_(profile.beam_origin_radius_m) {
  const std::size_t count = profile.rings.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Ring& ring = profile.rings[i];
    slopes_.push_back(std::tan(ring.elevation));
    heights_.push_back(ring.vertical_offset_m);
    double gap = std::numbers::pi;
    if (i > 0) gap = std::min(gap, profile.rings[i - 1].elevation - ring.elevation);
    if (i + 1 < count) gap = std::min(gap, ring.elevation - profile.rings[i + 1].elevation);
    half_gaps_.push_back(gap / 2);
  }
}

std::uint16_t Beams::nearest(double distance, double height) const {
  // Beams descend from top to bottom at every distance; where origins differ so much that
  // neighbours swap, the comparison of three mends it.
  std::size_t low = 0, high = size();
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (height_at(middle, distance) > height) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  const std::size_t first = low > 1 ? low - 2 : 0, last = std::min(low + 1, size() - 1);
  std::size_t best = first;
  double best_tangent = -1;
  for (std::size_t beam = first; beam <= last; ++beam) {
    // The tangent of the angle between both directions; behind a right angle there is no match.
    const double at = height_at(beam, distance);
    const double along = distance * distance + height * at;
    const double tangent = along > 0 ? std::abs(height - at) * distance / along : 1e300;
    if (best_tangent < 0 || tangent < best_tangent) {
      best = beam;
      best_tangent = tangent;
    }
  }
  return static_cast<std::uint16_t>(best);
}

double Beams::angle_above(std::size_t beam, double distance, double height) const {
  return std::atan2(height, distance) - std::atan2(height_at(beam, distance), distance);
}

}  // namespace curlidar
