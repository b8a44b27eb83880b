// SPDX-License-Identifier: BSD-3-Clause
// Does a scan come from a sensor that we know?
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "curlidar/sensor.hpp"
#include "sensor/cones.hpp"

namespace curlidar {

/// A built-in sensor that explains the elevations of a scan.
struct SensorMatch {
  SensorProfile profile;
  /// Ring of each cone (kNoRing for those without returns that fall outside).
  std::vector<std::uint16_t> ring_of_cone;
  double error = 0;                    ///< rms angle between cones and rings, radians
  std::vector<std::string> also_fits;  ///< sensors with the same rings, told apart by columns
};

/// The built-in sensor whose rings are the cones (top to bottom), within 0.15 degrees rms; sensors
/// with more rings fit too if the cones are rings of theirs within a tenth of the gaps. Among
/// equals the one whose columns are nearest to `columns` (0: not known) wins.
std::optional<SensorMatch> match_cones(const std::vector<Cone>& cones, const Returns& returns,
                                       double columns);

/// The built-in sensor near whose beams the returns lie far more often than by chance, whatever
/// their order; ring_of_cone stays empty.
std::optional<SensorMatch> match_returns(const Returns& returns, double columns);

}  // namespace curlidar
