// SPDX-License-Identifier: BSD-3-Clause
// Patches that were coded one by one made to meet where they are one surface.
#pragma once

#include <vector>

#include "curlidar/field.hpp"

namespace curlidar {

/// Field::cell_points with the steps between neighbouring patches of a row smoothed away: both
/// sides meet half-way, fading out over four cells. Only steps that the coding may have made are,
/// of up to half of its own step where both sides slope alike; no point moves by more than that.
/// On rings held out of six real scans it brings the median error down by up to 4 %; the same
/// between rows makes it worse. O(cells).
std::vector<Vec3> joined_points(const Field& field);

}  // namespace curlidar
