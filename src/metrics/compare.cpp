// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/compare.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/try.hpp"
#include "cloud/neighbours.hpp"

namespace curlidar {

DistanceStats summarise(std::vector<double> distances) {
  std::erase_if(distances, [](double d) { return std::isnan(d); });
  DistanceStats stats;
  stats.count = distances.size();
  if (distances.empty()) return stats;
  const auto n = static_cast<double>(distances.size());
  double sum = 0;
  double sum_of_squares = 0;
  for (const double d : distances) {
    sum += d;
    sum_of_squares += d * d;
    stats.max = std::max(stats.max, d);
  }
  stats.mean = sum / n;
  stats.rms = std::sqrt(sum_of_squares / n);
  double spread = 0;
  for (const double d : distances) spread += (d - stats.mean) * (d - stats.mean);
  stats.std = std::sqrt(spread / n);
  stats.p50 = percentile(distances, 0.5);
  stats.p95 = percentile(distances, 0.95);
  return stats;
}

Result<std::vector<double>> nearest_distances(const Cloud& from, const Cloud& to,
                                              std::size_t threads) {
  return distances_to_nearest(from, to, threads);
}

Result<Comparison> compare(const Cloud& a, const Cloud& b, std::size_t threads) {
  CURLIDAR_TRY_ASSIGN(from_a, nearest_distances(a, b, threads));
  CURLIDAR_TRY_ASSIGN(from_b, nearest_distances(b, a, threads));
  Comparison comparison;
  comparison.a_to_b = summarise(std::move(from_a));
  comparison.b_to_a = summarise(std::move(from_b));
  comparison.points_a = comparison.a_to_b.count;
  comparison.points_b = comparison.b_to_a.count;
  return comparison;
}

}  // namespace curlidar
