// SPDX-License-Identifier: BSD-3-Clause
// The yaw of a compensated scan, which elevations do not show: encoder angles lie on steps.
#pragma once

#include "sensor/motion_search.hpp"

namespace curlidar {

/// About the z axis, radians a turn of the sensor, and a turn squared.
struct Yaw {
  double turn = 0, turn2 = 0;
};

/// The yaw at which the azimuths of a sample agree best with the encoder's steps, all else of the
/// motion (without yaw) undone; of constant rate, or also of a rate that changes evenly. Right to a
/// fraction of a step. Tries every rate within +-0.35; O(slots) passes over a few thousand phases.
Yaw scan_yaw(const LatticeSample& sample, const BeamModel& model, const MotionTwist& motion,
             bool changing);

}  // namespace curlidar
