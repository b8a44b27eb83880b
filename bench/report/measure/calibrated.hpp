// SPDX-License-Identifier: BSD-3-Clause
// What is told of held-out rings, were it known what they measure too far.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "curlidar/field.hpp"
#include "curlidar/vec3.hpp"

namespace curlidar::bench {

/// Estimates with the median error of their ring added, each fitted on the sectors of the turn (10
/// degrees) on either side of its own: what a calibration of the held-out rings would bring.
/// `returns` and `rings` are of the held-out returns, `told` may go on after them.
std::vector<RangeEstimate> calibrated(std::vector<RangeEstimate> told,
                                      std::span<const Vec3> returns, std::span<const double> true_m,
                                      std::span<const std::uint16_t> rings);

}  // namespace curlidar::bench
