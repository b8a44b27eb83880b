// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/ring_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "curlidar/cloud.hpp"

namespace curlidar::bench {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kColumnsAway = 1.5;
constexpr double kSameSurface = 1.2;  ///< ratio of two ranges that may be mixed

/// The angle turned into [0, 2 pi).
double ahead(double angle) {
  const double within = angle - std::floor(angle / kTurn) * kTurn;
  return within < kTurn ? within : 0;
}

}  // namespace

double mix_ranges(double a, double b, double weight, Mixing mixing) {
  if (std::isnan(a)) return weight >= 0.5 ? b : kNan;
  if (std::isnan(b)) return weight <= 0.5 ? a : kNan;
  const bool apart = std::max(a, b) > kSameSurface * std::min(a, b);
  if (mixing == Mixing::edge_aware && apart) return weight < 0.5 ? a : b;
  return 1 / ((1 - weight) / a + weight / b);
}

std::optional<RingSamples::Sample> RingSamples::seen_from(const Viewpoint& from, const Vec3& p) {
  const double ahead_squared = p.x * p.x + p.y * p.y - from.left_m * from.left_m;
  if (!(ahead_squared > 0)) return std::nullopt;
  const double ahead = std::sqrt(ahead_squared), up = p.z - from.up_m;
  const double azimuth = azimuth_of(p) - std::atan2(from.left_m, ahead);
  return Sample{std::remainder(azimuth, kTurn), std::atan2(up, ahead), std::hypot(ahead, up)};
}

RingSamples::RingSamples(std::span<const Vec3> positions,
                         std::span<const std::uint16_t> ring_of_point,
                         std::vector<double> elevations, std::uint32_t columns,
                         const Viewpoint& from)
    : rings_(elevations.size()), elevations_(std::move(elevations)), columns_(columns) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3& p = positions[i];
    if (!is_return(p) || ring_of_point[i] >= rings_.size()) continue;
    if (const auto sample = seen_from(from, p)) rings_[ring_of_point[i]].push_back(*sample);
  }
  for (std::vector<Sample>& ring : rings_) {
    std::stable_sort(ring.begin(), ring.end(),
                     [](const Sample& a, const Sample& b) { return a.azimuth < b.azimuth; });
  }
}

RingSamples::Seen RingSamples::see(std::size_t ring, double azimuth, Mixing mixing) const {
  const std::vector<Sample>& samples = rings_[ring];
  if (samples.empty()) return {elevations_[ring], kNan};
  const auto above = std::upper_bound(samples.begin(), samples.end(), azimuth,
                                      [](double at, const Sample& s) { return at < s.azimuth; });
  const Sample& right = above == samples.end() ? samples.front() : *above;
  const Sample& left = above == samples.begin() ? samples.back() : *std::prev(above);
  const double reach = kColumnsAway * kTurn / columns_;
  const double to_left = ahead(azimuth - left.azimuth), to_right = ahead(right.azimuth - azimuth);
  if (to_left > reach && to_right > reach) return {elevations_[ring], kNan};
  if (to_right > reach) return {left.elevation, left.range_m};
  if (to_left > reach) return {right.elevation, right.range_m};
  const double gap = to_left + to_right;
  const double weight = gap > 0 ? to_left / gap : 0;
  return {left.elevation + (right.elevation - left.elevation) * weight,
          mix_ranges(left.range_m, right.range_m, weight, mixing)};
}

RingSamples::Mixed RingSamples::mix(const Vec3& direction, Mixing mixing) const {
  const double elevation = elevation_of(direction), azimuth = azimuth_of(direction);
  std::vector<Seen>::size_type low = 0, high = rings_.size();
  while (low < high) {  // the first ring below the direction
    const std::size_t middle = (low + high) / 2;
    if (see(middle, azimuth, mixing).elevation > elevation) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low == rings_.size()) return {kNan, 0};
  const Seen bottom = see(low, azimuth, mixing);
  if (bottom.elevation == elevation) return {bottom.range_m, 1};
  if (low == 0) return {kNan, 0};
  const Seen top = see(low - 1, azimuth, mixing);
  const double gap = top.elevation - bottom.elevation;
  const double a = top.range_m, b = bottom.range_m;
  const bool alone = std::isnan(a) || std::isnan(b);
  return {mix_ranges(a, b, (top.elevation - elevation) / gap, mixing),
          alone ? 0 : std::min(a, b) / std::max(a, b)};
}

}  // namespace curlidar::bench
