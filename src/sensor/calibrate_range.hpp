// SPDX-License-Identifier: BSD-3-Clause
// The unit that a sensor counts ranges in.
#pragma once

#include <span>

#include "sensor/calibrate_sample.hpp"

namespace curlidar::calibration {

/// Sets range_unit_m to the largest unit whose multiples, plus a phase for each beam, the ranges of
/// the scans are, and the phases (within half a unit of 0); no unit leaves both 0. Beams and
/// motions must be known. Returns the resultant: 1 for exact multiples, about 0 for none.
double find_range_unit(std::span<const ScanSample> samples, BeamModel& model);

}  // namespace curlidar::calibration
