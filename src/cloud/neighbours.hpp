// SPDX-License-Identifier: BSD-3-Clause
// Nearest neighbours between clouds.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// What nearest_distances of curlidar/compare.hpp promises.
Result<std::vector<double>> distances_to_nearest(const Cloud& from, const Cloud& to,
                                                 std::size_t threads);

/// The larger of the two mean distances to the nearest neighbour, a to b and b to a; 0 if both are
/// empty. Errors: invalid_argument (one has no return).
Result<double> worse_mean_distance(const Cloud& a, const Cloud& b, std::size_t threads);

}  // namespace curlidar
