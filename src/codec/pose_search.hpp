// SPDX-License-Identifier: BSD-3-Clause
// How a sensor moved since a decoded scan, found as the prediction needs it: between the frames in
// which the lattices of both scans lie.
#pragma once

#include <vector>

#include "codec/compact_model.hpp"
#include "compact/relative_pose.hpp"
#include "compact/scan_decoder.hpp"
#include "curlidar/motion.hpp"

namespace curlidar {

/// T_scan_reference between the fields' centres: point to plane, surfaces of the reference against
/// the returns of the cells that they fall into. `guesses`: where to begin, the best of what they
/// lead to is taken; T_reference_scan of the clouds. The same on every machine. Some 100 ms a
/// guess.
compact::RelativePose find_pose(const compact::DecodedScan& reference, const CompactModel& model,
                                const std::vector<RigidMotion>& guesses);

}  // namespace curlidar
