// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/cones.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sensor/angles.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kSample = 256;

/// Indices of the returns of each label, far ones only where there are some, evenly thinned.
void take_samples(const Returns& returns, const Labels& labels, std::vector<Cone>& cones) {
  std::vector<std::size_t> far(labels.count, 0);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::uint16_t label = labels.of_return[i];
    if (label == kNoLabel) continue;
    ++cones[label].returns;
    if (returns.is_far(i)) ++far[label];
  }
  std::vector<std::size_t> seen(labels.count, 0);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::uint16_t label = labels.of_return[i];
    if (label == kNoLabel) continue;
    const bool far_only = far[label] > 0;
    if (far_only && !returns.is_far(i)) continue;
    const std::size_t candidates = far_only ? far[label] : cones[label].returns;
    const std::size_t stride = (candidates + kSample - 1) / kSample;
    if (seen[label]++ % stride == 0) {
      cones[label].sample.push_back(static_cast<std::uint32_t>(i));
    }
  }
}

/// Angles between the sample and height = origin + slope * distance, fitted robustly.
void fit_cone(const Returns& returns, Cone& cone) {
  double slope = std::tan(std::clamp(cone.elevation, -1.55, 1.55));
  double origin = 0;
  const double scale = 0.05 * kRadiansPerDegree;
  const auto residual = [&](std::uint32_t i) {
    const double line = origin + slope * returns.distance[i];
    return (returns.height[i] - line) * returns.distance[i] / (returns.range[i] * returns.range[i]);
  };
  for (int iteration = 0; iteration < 6; ++iteration) {
    // Beams start near the sensor's origin: a weak prior keeps walls at one distance harmless.
    double w = 1e-4, wx = 0, wxx = 0, wy = 0, wxy = 0;
    for (const std::uint32_t i : cone.sample) {
      const double x = returns.distance[i], y = returns.height[i], r = residual(i) / scale;
      const double weight = 1 / ((1 + r * r) * (1e-6 + returns.range[i] * returns.range[i]));
      w += weight;
      wx += weight * x;
      wxx += weight * x * x;
      wy += weight * y;
      wxy += weight * x * y;
    }
    const double determinant = w * wxx - wx * wx;
    if (!(determinant > 1e-12 * w * wxx)) break;
    slope = (w * wxy - wx * wy) / determinant;
    origin = (wxx * wy - wx * wxy) / determinant;
  }
  std::vector<double> angles;
  angles.reserve(cone.sample.size());
  for (const std::uint32_t i : cone.sample) angles.push_back(std::abs(residual(i)));
  cone.spread = median(angles);
  cone.tail = percentile(angles, 0.9);
}

void place_empty(const std::vector<Cone>& cones, std::vector<double>& elevations) {
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < cones.size(); ++i) {
    if (cones[i].returns > 0) known.push_back(i);
  }
  const std::size_t first = known.front(), last = known.back();
  const double step =
      last > first ? (elevations[first] - elevations[last]) / static_cast<double>(last - first)
                   : kRadiansPerDegree;
  const double limit = std::numbers::pi / 2;
  const double up = std::min(step, (limit - elevations[first]) / static_cast<double>(first + 1));
  const double down =
      std::min(step, (limit + elevations[last]) / static_cast<double>(cones.size() - last));
  for (std::size_t i = 0; i < first; ++i) {
    elevations[i] = elevations[first] + up * static_cast<double>(first - i);
  }
  for (std::size_t i = last + 1; i < cones.size(); ++i) {
    elevations[i] = elevations[last] - down * static_cast<double>(i - last);
  }
  for (std::size_t k = 1; k < known.size(); ++k) {
    const std::size_t a = known[k - 1], b = known[k];
    for (std::size_t i = a + 1; i < b; ++i) {
      const double t = static_cast<double>(i - a) / static_cast<double>(b - a);
      elevations[i] = elevations[a] + t * (elevations[b] - elevations[a]);
    }
  }
}

}  // namespace

std::vector<Cone> fit_cones(const Returns& returns, const Labels& labels) {
  std::vector<Cone> cones(labels.count);
  for (std::size_t label = 0; label < labels.count; ++label) cones[label].label = label;
  take_samples(returns, labels, cones);
  std::vector<double> values;
  for (Cone& cone : cones) {
    if (cone.returns == 0) continue;
    values.clear();
    for (const std::uint32_t i : cone.sample) values.push_back(returns.elevation[i]);
    cone.elevation = median(values);
    fit_cone(returns, cone);
  }
  return cones;
}

bool are_rings(const std::vector<Cone>& cones) {
  std::vector<double> spreads, elevations, gaps;
  for (const Cone& cone : cones) {
    if (cone.returns == 0) continue;
    spreads.push_back(cone.spread);
    elevations.push_back(cone.elevation);
  }
  if (elevations.empty()) return false;
  std::sort(elevations.begin(), elevations.end());
  for (std::size_t i = 1; i < elevations.size(); ++i) {
    gaps.push_back(elevations[i] - elevations[i - 1]);
  }
  const double gap = gaps.empty() ? 0 : median(gaps);
  return median(spreads) <= std::max(0.15 * kRadiansPerDegree, 0.4 * gap);
}

std::vector<Cone> top_to_bottom(std::vector<Cone> cones) {
  const auto drop_empty = [&] {
    std::erase_if(cones, [](const Cone& cone) { return cone.returns == 0; });
  };
  std::size_t up = 0, down = 0;
  const Cone* previous = nullptr;
  for (const Cone& cone : cones) {
    if (cone.returns == 0) continue;
    if (previous != nullptr) ++(cone.elevation > previous->elevation ? up : down);
    previous = &cone;
  }
  if (10 * std::max(up, down) < 9 * (up + down)) {
    drop_empty();
    std::stable_sort(cones.begin(), cones.end(),
                     [](const Cone& a, const Cone& b) { return a.elevation > b.elevation; });
    return cones;
  }
  if (up + down == 0) drop_empty();
  if (up > down) std::reverse(cones.begin(), cones.end());
  return cones;
}

std::vector<double> elevations_of(const std::vector<Cone>& cones) {
  std::vector<double> elevations;
  for (const Cone& cone : cones) elevations.push_back(cone.elevation);
  place_empty(cones, elevations);
  make_strictly_descending(elevations);
  return elevations;
}

void make_strictly_descending(std::vector<double>& values) {
  // Pool adjacent violators, then part the equal ones by an angle far below any sensor's noise.
  struct Pool {
    double sum;
    std::size_t size;
    double mean() const { return sum / static_cast<double>(size); }
  };
  std::vector<Pool> pools;
  for (const double value : values) {
    pools.push_back({value, 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() < pools.back().mean()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back().sum += last.sum;
      pools.back().size += last.size;
    }
  }
  std::size_t i = 0;
  for (const Pool& pool : pools) {
    for (std::size_t k = 0; k < pool.size; ++k)
      values[i++] = pool.size > 1 ? pool.mean() : pool.sum;
  }
  constexpr double kStep = 1e-9;
  const double limit = std::numbers::pi / 2;
  const double lowest = -limit + kStep * static_cast<double>(values.size());
  double ceiling = limit;
  for (double& value : values) {
    value = std::min(std::max(value, lowest), ceiling);
    ceiling = value - kStep;
  }
}

}  // namespace curlidar
