// SPDX-License-Identifier: BSD-3-Clause
// A sensor's own profile from its scans: exact beams, so that scans are coded on the sensor's rays.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/progress.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"
#include "curlidar/vec3.hpp"

namespace curlidar {

struct SensorCalibrationSettings {
  std::string name = "calibrated";  ///< of the profile
  /// A profile with about the right rings, where those found in the scans are wrong.
  std::optional<SensorProfile> start;
  bool motion = true;       ///< whether the scans may be motion-compensated
  std::size_t threads = 0;  ///< 0 = all cores; the result does not depend on it
  ProgressCallback progress;
};

/// How one scan lies on the lattice of the sensor: rings x encoder positions x range units.
struct ScanOnLattice {
  std::size_t returns = 0;
  std::size_t placed = 0;  ///< returns with a place of their own; 0: the scan is not on the lattice
  std::size_t firings = 0;  ///< encoder positions with a return
  double share = 0;         ///< of the returns that lie within 1.5 mm of their place
  /// Distances of returns from their places, metres: median and 95th percentile. Ranges are
  /// compared with multiples of the range unit.
  double across_median_m = 0, across_p95_m = 0;
  double up_median_m = 0, up_p95_m = 0;
  double range_median_m = 0, range_p95_m = 0;
  bool compensated = false;  ///< whether a motion compensation was found and undone
  Vec3 turn, move;           ///< that motion in a turn of the sensor: radians, metres
  std::vector<std::string> notes;
};

struct SensorCalibration {
  SensorProfile sensor;  ///< with slots, offsets of every ring and, where there is one, range unit
  RingSource ring_source = RingSource::uniform;  ///< how the rings of the first scan were found
  std::vector<ScanOnLattice> scans;              ///< one for each cloud
};

/// Finds the beams of the sensor that made the clouds: elevations, offsets in azimuth, height and
/// to the side, range phases, encoder positions of a turn and the range unit, from nothing but the
/// returns; motion compensation is undone on the way, each cloud's own. Several scans are better
/// than one. Errors: invalid_argument (no cloud, no return, different sensors), unsupported (the
/// returns lie on no lattice, which the message explains).
/// Time: one to two seconds for each 100,000 returns. Deterministic.
Result<SensorCalibration> calibrate_sensor(std::span<const Cloud> clouds,
                                           const SensorCalibrationSettings& settings = {});

}  // namespace curlidar
