// SPDX-License-Identifier: BSD-3-Clause
#include "protocol/ring_split.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <fmt/format.h>

#include "curlidar/lattice.hpp"

namespace curlidar::bench {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kGapColumns = 1.8;  ///< returns on neighbouring columns are nearer than that

/// Directions on the columns that are missing between a ring's returns.
void add_gaps(std::vector<Vec3> ring, std::uint32_t columns, std::vector<Vec3>& gaps) {
  const double column = kTurn / columns;
  std::sort(ring.begin(), ring.end(),
            [](const Vec3& a, const Vec3& b) { return azimuth_of(a) < azimuth_of(b); });
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3 &right = ring[i], &left = ring[(i + 1) % ring.size()];
    double wide = azimuth_of(left) - azimuth_of(right);
    if (wide < 0) wide += kTurn;
    if (wide < kGapColumns * column) continue;
    const auto missing = static_cast<std::size_t>(std::lround(wide / column));
    for (std::size_t j = 1; j < missing; ++j) {
      const double part = static_cast<double>(j) / static_cast<double>(missing);
      const double up = elevation_of(right) * (1 - part) + elevation_of(left) * part;
      gaps.push_back(direction_of(up, azimuth_of(right) + part * wide));
    }
  }
}

}  // namespace

RingSplit split_rings(const Cloud& cloud, const Detection& detection, std::uint32_t every) {
  RingSplit split;
  const std::size_t rings = detection.sensor.rings.size();
  const std::size_t last = (rings - 1) / every * every;
  split.sensor = detection.sensor;
  split.sensor.name = fmt::format("{}-every-{}", detection.sensor.name, every);
  split.sensor.rings.clear();
  for (std::size_t ring = 0; ring <= last; ring += every) {
    split.sensor.rings.push_back(detection.sensor.rings[ring]);
    split.elevations.push_back(detection.ring_elevations[ring]);
  }
  std::vector<std::uint32_t> coded;
  std::vector<std::vector<Vec3>> held_out(rings);
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const std::uint16_t ring = detection.ring_of_point[i];
    if (!is_return(cloud.positions[i]) || ring > last) continue;
    if (ring % every == 0) {
      coded.push_back(i);
      split.ring_of_point.push_back(static_cast<std::uint16_t>(ring / every));
    } else {
      split.held_out.push_back(cloud.positions[i]);
      split.held_out_ring.push_back(ring);
      held_out[ring].push_back(cloud.positions[i]);
    }
  }
  for (std::uint16_t ring = 0; ring < rings; ++ring) {
    add_gaps(held_out[ring], detection.sensor.columns, split.gaps);
    split.gap_ring.resize(split.gaps.size(), ring);
  }
  split.coded = select(cloud, coded);
  split.coded.attributes.clear();
  return split;
}

}  // namespace curlidar::bench
