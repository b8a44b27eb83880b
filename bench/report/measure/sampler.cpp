// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/sampler.hpp"

#include <cmath>
#include <cstddef>
#include <map>

namespace curlidar::bench {
namespace {

/// A line that starts beside the spin axis, where it passes it.
struct Passing {
  Viewpoint from;
  double before_m = 0;  ///< from there to where the line starts
};

Passing passing(const Sightline& line) {
  const double azimuth = azimuth_of(line.direction);
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  const double ahead = line.origin.x * c + line.origin.y * s;
  const double before = ahead / std::hypot(line.direction.x, line.direction.y);
  return {{line.origin.y * c - line.origin.x * s, line.origin.z - line.direction.z * before},
          before};
}

}  // namespace

std::vector<RangeEstimate> Sampler::tell(std::span<const Vec3> directions) const {
  std::vector<Sightline> lines;
  for (const Vec3& direction : directions) lines.push_back({{}, direction});
  return along(lines);
}

std::vector<RangeEstimate> FieldSampler::along(std::span<const Sightline> lines) const {
  std::vector<RangeEstimate> told(lines.size());
  field_->range_along(lines, told);
  return told;
}

std::vector<RangeEstimate> RingSampler::along(std::span<const Sightline> lines) const {
  constexpr double kUnit_m = 1e-4;  // viewpoints nearer to each other are one
  std::map<std::pair<long, long>, std::vector<std::size_t>> by_viewpoint;
  std::vector<Passing> passings;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    passings.push_back(passing(lines[i]));
    const Viewpoint& from = passings.back().from;
    by_viewpoint[{std::lround(from.left_m / kUnit_m), std::lround(from.up_m / kUnit_m)}].push_back(
        i);
  }
  std::vector<RangeEstimate> told(lines.size());
  for (const auto& [key, indices] : by_viewpoint) {
    const RingSamples samples(rings_->positions, rings_->ring_of_point, rings_->elevations,
                              rings_->columns, passings[indices.front()].from);
    for (const std::size_t i : indices) {
      const RingSamples::Mixed mixed = samples.mix(lines[i].direction, mixing_);
      if (std::isnan(mixed.range_m)) continue;
      told[i] = {mixed.range_m - passings[i].before_m, static_cast<float>(mixed.agreement),
                 Seen::surface};
    }
  }
  return told;
}

}  // namespace curlidar::bench
