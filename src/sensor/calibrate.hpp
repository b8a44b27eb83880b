// SPDX-License-Identifier: BSD-3-Clause
// Finds the beams of a sensor from its scans alone, exactly enough for the sensor's own lattice.
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
#include "sensor/lattice.hpp"
#include "sensor/motion.hpp"

namespace curlidar {

/// A scan and which beam each of its returns came from.
struct RingedScan {
  const Cloud* cloud = nullptr;
  const Detection* rings = nullptr;
};

struct CalibrateSettings {
  bool motion = true;       ///< whether the scans may be motion-compensated
  std::size_t threads = 0;  ///< 0 = all cores; the result does not depend on it
  ProgressCallback progress;
};

/// What scans of one sensor say about it.
struct Calibration {
  BeamModel model;
  std::vector<MotionTwist> motions;  ///< of every scan; all zero: not compensated
  /// Median distances of returns from their places: out of the beams' cones and along the rows.
  double up_median_m = 0, across_median_m = 0;
  /// Share of the ranges' resultant that the range unit explains, 1: exact multiples.
  double range_resultant = 0;
  std::vector<std::string> notes;
};

/// Most scans that are looked at; of more, evenly chosen ones.
inline constexpr std::size_t kMaxCalibrationScans = 24;

/// Finds elevation, height, azimuth offset, lateral offset and range phase of every beam, the
/// encoder positions of a turn and the range unit, and undoes each scan's own motion compensation
/// on the way. Scans share one sensor: their detections must have the same number of rings, in the
/// same order. Nothing if the returns lie on no lattice of azimuths, or no cones at all.
/// Errors: invalid_argument (no scan, detections that do not belong together).
/// Time: about a second for each 100,000 returns; deterministic.
Result<std::optional<Calibration>> calibrate(std::span<const RingedScan> scans,
                                             const CalibrateSettings& settings = {});

/// A profile with these beams; columns, limits and description are those of `nominal`, which must
/// have as many rings. beam_model_of() gives the model back.
/// Errors: unsupported (beams whose elevations do not descend cannot be a profile).
Result<SensorProfile> profile_of(const BeamModel& model, const SensorProfile& nominal,
                                 const std::string& name);

}  // namespace curlidar
