// SPDX-License-Identifier: BSD-3-Clause
// Fewer points, evenly spread.
#pragma once

#include <span>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar::registration {

/// The returns whose range lies in [min, max].
std::vector<Vec3> returns_in_range(const Cloud& cloud, double min_range_m, double max_range_m);

/// The first point of every cell of a cubic grid, in the order of the points. O(n).
std::vector<Vec3> thinned(std::span<const Vec3> points, double voxel_m);

}  // namespace curlidar::registration
