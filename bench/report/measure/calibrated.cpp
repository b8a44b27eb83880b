// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/calibrated.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "curlidar/compare.hpp"
#include "curlidar/lattice.hpp"

namespace curlidar::bench {
namespace {

constexpr double kSector = 2 * std::numbers::pi / 36;

/// Even and odd sectors of a ring by turns.
std::pair<std::uint16_t, bool> half_of(const Vec3& p, std::uint16_t ring) {
  const double sector = std::floor((azimuth_of(p) + std::numbers::pi) / kSector);
  return {ring, std::fmod(sector, 2) != 0};
}

}  // namespace

std::vector<RangeEstimate> calibrated(std::vector<RangeEstimate> told,
                                      std::span<const Vec3> returns, std::span<const double> true_m,
                                      std::span<const std::uint16_t> rings) {
  std::map<std::pair<std::uint16_t, bool>, std::vector<double>> errors;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (!told[i].valid()) continue;
    errors[half_of(returns[i], rings[i])].push_back(true_m[i] - told[i].range_m);
  }
  std::map<std::pair<std::uint16_t, bool>, double> bias;
  for (auto& [half, values] : errors) {
    std::sort(values.begin(), values.end());
    bias[half] = percentile(values, 0.5);
  }
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const auto [ring, odd] = half_of(returns[i], rings[i]);
    const auto found = bias.find({ring, !odd});
    if (told[i].valid() && found != bias.end()) told[i].range_m += found->second;
  }
  return told;
}

}  // namespace curlidar::bench
