// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sensor/returns.hpp"

namespace curlidar {

/// Elevations (descending) at which the returns crowd, if they crowd clearly enough to be beams;
/// empty otherwise. One elevation for a planar scan. O(n).
std::vector<double> cluster_elevations(const Returns& returns);

}  // namespace curlidar
