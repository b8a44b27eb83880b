// SPDX-License-Identifier: BSD-3-Clause
// Which encoder positions of different beams belong to one firing.
#pragma once

#include <span>

#include "sensor/calibrate_sample.hpp"

namespace curlidar::calibration {

/// Adds whole pitches to the azimuth offsets, so that returns of one firing share an encoder
/// position. In organised clouds whose columns are the encoder's positions a column is a firing;
/// elsewhere beams fire together where that makes most returns share positions, and as they are
/// (offsets within half a pitch) where every choice does as well.
void align_firings(std::span<const ScanSample> samples, BeamModel& model);

}  // namespace curlidar::calibration
