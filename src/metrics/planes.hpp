// SPDX-License-Identifier: BSD-3-Clause
// Distances from points to the planes of their neighbours.
#pragma once

#include <cstddef>
#include <vector>

#include "cloud/neighbours.hpp"
#include "curlidar/cloud.hpp"

namespace curlidar {

/// Mean squared distances to planes, both ways, m2.
struct PlaneErrors {
  double a_to_b = 0, b_to_a = 0;
};

/// What measure() of curlidar/metrics.hpp says of D2. `normals` are those of a, one a slot;
/// `from_a` and `from_b` the nearest returns of the other cloud, one a slot. Both clouds have
/// returns. O(n).
PlaneErrors plane_errors(const Cloud& a, const Cloud& b, const std::vector<Vec3>& normals,
                         const std::vector<Neighbour>& from_a,
                         const std::vector<Neighbour>& from_b);

}  // namespace curlidar
