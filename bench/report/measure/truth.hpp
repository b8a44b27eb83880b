// SPDX-License-Identifier: BSD-3-Clause
// Simulated scans and what points between their rows are worth.
#pragma once

#include <cstdint>
#include <memory>
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

/// The limits that the paper's settings come to on the cloud.
Result<RangeLimits> limits_of(const Cloud& cloud, const EncodeSettings& settings);

/// Each ray against the surface that it meets.
RayErrors judge(const Scene& scene, const std::vector<RayRange>& rays, const RangeLimits& limits);

}  // namespace curlidar::bench
