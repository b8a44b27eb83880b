// SPDX-License-Identifier: BSD-3-Clause
// Least squares over beams and motions together.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sensor/calibrate_sample.hpp"

namespace curlidar::calibration {

/// What a refinement may move.
struct RefineSettings {
  bool azimuth = false;  ///< use azimuths (offset and lateral of the beams), not elevations alone
  bool motion = false;   ///< move the motions too; without azimuths all but the yaw
  int most_steps = 12;
  double start_scale_m = 0.5;  ///< residuals well above this count little at first
  std::size_t threads = 0;     ///< at most one for each scan; 0 = all cores
};

/// Median absolute distances of returns from their places, metres.
struct Misfit {
  double up_m = 0;      ///< out of the beam's cone
  double across_m = 0;  ///< along the row; 0 without azimuths
};

/// Gauss-Newton steps over all returns with weights that fade outliers out; beams in model.beams
/// and the motions of the samples are changed. The scale of the weights follows the median
/// residual. Returns the misfit before the last step.
Misfit refine(std::span<ScanSample> samples, BeamModel& model, const RefineSettings& settings);

}  // namespace curlidar::calibration
