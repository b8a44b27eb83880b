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

}  // namespace curlidar
