// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/columns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace curlidar {

double columns_from_steps(const Returns& returns, const Labels& labels) {
  constexpr std::size_t kRings = 12;
  std::vector<std::size_t> sizes(labels.count, 0), order(labels.count);
  for (const std::uint16_t label : labels.of_return) {
    if (label != kNoLabel) ++sizes[label];
  }
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sizes[a] > sizes[b]; });
  order.resize(std::min(order.size(), kRings));
  std::vector<std::vector<double>> azimuths(labels.count);
  for (const std::size_t label : order) azimuths[label].reserve(sizes[label]);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::uint16_t label = labels.of_return[i];
    if (label != kNoLabel && azimuths[label].capacity() > 0) {
      azimuths[label].push_back(returns.azimuth[i]);
    }
  }
  std::vector<double> steps;
  for (const std::size_t label : order) {
    std::vector<double>& ring = azimuths[label];
    std::sort(ring.begin(), ring.end());
    for (std::size_t i = 1; i < ring.size(); ++i) {
      // Second returns of a firing have nearly the same azimuth.
      if (ring[i] - ring[i - 1] > 2e-4) steps.push_back(ring[i] - ring[i - 1]);
    }
  }
  if (steps.size() < 32) return 0;
  return std::clamp(2 * std::numbers::pi / median(steps), 4.0, 65536.0);
}

std::uint32_t usual_columns(double columns) {
  double best = std::clamp(std::round(columns), 4.0, 65536.0);
  double error = 0.02;
  for (const double usual : {512.0, 600.0, 900.0, 1024.0, 1800.0, 2000.0, 2048.0, 2083.0, 2170.0,
                             3600.0, 4000.0, 4096.0}) {
    if (std::abs(columns / usual - 1) < error) {
      error = std::abs(columns / usual - 1);
      best = usual;
    }
  }
  return static_cast<std::uint32_t>(best);
}

}  // namespace curlidar
