// SPDX-License-Identifier: BSD-3-Clause
// Clouds made from a sensor profile, with rings that are known.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/sensor.hpp"

namespace curlidar::test {

/// A small generator with the same numbers everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2654435769u + 1) {}
  double uniform() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  /// Nearly normal, standard deviation 1.
  double normal() {
    double sum = 0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum - 6;
  }
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(uniform() * static_cast<double>(count));
  }

 private:
  std::uint64_t state_;
};

struct Synthetic {
  Cloud cloud;
  std::vector<std::uint16_t> ring;  ///< of each point
};

struct SyntheticOptions {
  std::size_t columns = 0;  ///< 0: those of the profile
  double noise_deg = 0.02;
  double near_m = 4, far_m = 40;
  double azimuth_from = 0, azimuth_to = 2 * std::numbers::pi;
};

/// Returns ring by ring, top ring first, each from azimuth_from counter-clockwise.
inline Synthetic make_scan(const SensorProfile& profile, SyntheticOptions options = {}) {
  Synthetic out;
  Random random(7);
  const std::size_t columns = options.columns != 0 ? options.columns : profile.columns;
  for (std::size_t k = 0; k < profile.rings.size(); ++k) {
    const Ring& ring = profile.rings[k];
    for (std::size_t j = 0; j < columns; ++j) {
      const double azimuth =
          2 * std::numbers::pi * (static_cast<double>(j) + 0.5) / static_cast<double>(columns);
      if (azimuth < options.azimuth_from || azimuth >= options.azimuth_to) continue;
      const double range = options.near_m + (options.far_m - options.near_m) * random.uniform();
      const double noise = options.noise_deg * std::numbers::pi / 180 * random.normal();
      Vec3 p = direction_of(ring.elevation + noise, azimuth) * range;
      out.cloud.positions.push_back(p + Vec3{0, 0, ring.vertical_offset_m});
      out.ring.push_back(static_cast<std::uint16_t>(k));
    }
  }
  out.cloud.width = static_cast<std::uint32_t>(out.cloud.size());
  return out;
}

inline void shuffle(Synthetic& scan) {
  Random random(11);
  for (std::size_t i = scan.ring.size(); i > 1; --i) {
    const std::size_t j = random.below(i);
    std::swap(scan.cloud.positions[i - 1], scan.cloud.positions[j]);
    std::swap(scan.ring[i - 1], scan.ring[j]);
  }
}

/// Share of points whose ring was found.
inline double agreement(const Synthetic& scan, const Detection& detection) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < scan.ring.size(); ++i) {
    right += scan.ring[i] == detection.ring_of_point[i];
  }
  return static_cast<double>(right) / static_cast<double>(scan.ring.size());
}

}  // namespace curlidar::test
