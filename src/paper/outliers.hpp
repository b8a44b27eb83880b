// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar {

/// keep[i] is true for returns with at least `min_points` returns (itself included) within
/// `radius_m`; returns farther than 5e8 radii from the origin are never kept. Exact; O(n) for
/// scans: a hash grid whose cells are small enough that a full cell settles all of its points at
/// once.
std::vector<bool> find_inliers(const Cloud& cloud, double radius_m, std::uint32_t min_points);

}  // namespace curlidar
