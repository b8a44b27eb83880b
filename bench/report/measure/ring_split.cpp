// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/ring_split.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "curlidar/compare.hpp"
#include "curlidar/lattice.hpp"

namespace curlidar::bench {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kGapColumns = 1.8;  ///< returns on neighbouring columns are nearer than that
constexpr double kSector = kTurn / 36;

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

/// Even and odd sectors of a ring by turns.
std::pair<std::uint16_t, bool> half_of(const Vec3& p, std::uint16_t ring) {
  const double sector = std::floor((azimuth_of(p) + std::numbers::pi) / kSector);
  return {ring, std::fmod(sector, 2) != 0};
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
  for (const std::vector<Vec3>& ring : held_out) {
    add_gaps(ring, detection.sensor.columns, split.gaps);
  }
  split.coded = select(cloud, coded);
  split.coded.attributes.clear();
  return split;
}

std::vector<RangeEstimate> calibrated(std::vector<RangeEstimate> told,
                                      std::span<const Vec3> returns,
                                      std::span<const std::uint16_t> rings) {
  std::map<std::pair<std::uint16_t, bool>, std::vector<double>> errors;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (!told[i].valid()) continue;
    errors[half_of(returns[i], rings[i])].push_back(norm(returns[i]) - told[i].range_m);
  }
  std::map<std::pair<std::uint16_t, bool>, double> bias;
  for (auto& [half, values] : errors) {
    std::sort(values.begin(), values.end());
    bias[half] = percentile(values, 0.5);
  }
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const auto [ring, odd] = half_of(returns[i], rings[i]);
    const auto found = bias.find({ring, !odd});
    if (told[i].valid() && found != bias.end()) told[i].range_m += found->second;
  }
  return told;
}

}  // namespace curlidar::bench
