// SPDX-License-Identifier: BSD-3-Clause
// The motion of a compensated scan, found from the scan alone: undone, returns lie on their beams.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sensor/lattice.hpp"

namespace curlidar {

/// Some returns of a scan and the beams that saw them.
struct LatticeSample {
  std::vector<Vec3> points;
  std::vector<std::uint16_t> rings;  ///< index into the model's beams
};

/// How far the returns of a sample are from the lattice, metres.
struct SampleQuality {
  double up_median_m = 0;      ///< from the cones of the beams
  double across_median_m = 0;  ///< from the nearest encoder position
  double share = 0;            ///< of the returns within the tolerance of both
};
SampleQuality measure(const LatticeSample& sample, const BeamModel& model,
                      const MotionTwist& motion, double tolerance_m);

/// How many of the 18 numbers of a motion may differ from zero.
enum class MotionFreedom {
  twist,      ///< one turn and move for the whole scan: 6
  quadratic,  ///< also rates that change, and a rigid transform: 18
};

/// Gives every return of a sample the ring whose beam's cone is nearest once the motion is undone.
/// Returns how many changed.
std::size_t relabel(LatticeSample& sample, const BeamModel& model, const MotionTwist& motion);

/// The motion that brings a sample onto the lattice as well as possible; whether that is good
/// enough is for the caller to measure. Rings that are wrong for many returns spoil it: see
/// relabel(). Costs about 30 passes over the sample; deterministic.
MotionTwist search_motion(const LatticeSample& sample, const BeamModel& model,
                          MotionFreedom freedom = MotionFreedom::twist);

}  // namespace curlidar
