// SPDX-License-Identifier: BSD-3-Clause
// Simulated scans, and directions between their rings with the exact ranges there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "curlidar/simulate.hpp"
#include "report/measure/methods.hpp"

namespace curlidar::bench {

struct Simulated {
  std::shared_ptr<const Scene> scene;
  Cloud cloud;
  EncodeSettings settings;  ///< of Profile::paper with the sensor, no attributes, one thread
  Detection rings;
};

/// The simulator's default noise and dropouts, with a seed for world and noise.
Result<Simulated> simulate_scan(const std::string& scene, const std::string& sensor,
                                const std::string& preset, std::uint64_t seed);

/// What methods start from on a simulated scan.
MethodInput input_of(const Simulated& simulated);

/// Directions of `factor` times the rings, those on a ring left out: about `most` of them, spread
/// evenly. They are on the sensor's columns and between the outermost rings.
std::vector<Vec3> rays_between(const Detection& rings, double factor, std::size_t most);

/// The range of the surface that each ray from the origin meets; NaN where it meets none.
std::vector<double> true_ranges(const Scene& scene, std::span<const Vec3> directions);

}  // namespace curlidar::bench
