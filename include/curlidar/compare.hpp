// SPDX-License-Identifier: BSD-3-Clause
// Honest distances between two clouds, both ways.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// Statistics of a set of distances, metres. `std` is the population standard deviation; p50 and
/// p95 interpolate linearly between order statistics. All zero when there is no distance.
struct DistanceStats {
  std::size_t count = 0;
  double mean = 0, rms = 0, std = 0, p50 = 0, p95 = 0, max = 0;
};
/// NaN entries are left out of the set.
DistanceStats summarise(std::vector<double> distances);

struct Comparison {
  std::size_t points_a = 0, points_b = 0;  ///< returns compared
  DistanceStats a_to_b;  ///< from each return of a to its nearest neighbour in b
  DistanceStats b_to_a;
};

/// Distance from every slot of `from` to the nearest return of `to`; NaN where `from` has no
/// return. `to` must have a return. Exact (k-d tree), O(n log n). threads: 0 = all cores.
Result<std::vector<double>> nearest_distances(const Cloud& from, const Cloud& to,
                                              std::size_t threads = 1);

/// Nearest-neighbour distances both ways over returns. A cloud without returns is an error.
Result<Comparison> compare(const Cloud& a, const Cloud& b, std::size_t threads = 1);

}  // namespace curlidar
