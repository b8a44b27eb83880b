// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "curlidar/cloud.hpp"
#include "sensor/lattice.hpp"

namespace curlidar {

/// The cloud in the frame of the sensor at each return's own time: the motion compensation that
/// the fit found is undone, for returns on the lattice and for the others. Slots, attributes and
/// empty slots stay. O(n).
Cloud in_own_frame(const Cloud& cloud, const LatticeFit& fit);

}  // namespace curlidar
