// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/bvh.hpp"
#include "base/parallel.hpp"
#include "base/try.hpp"
#include "cloud/neighbours.hpp"
#include "curlidar/map_view.hpp"

namespace curlidar {
namespace {

constexpr float kNoError = std::numeric_limits<float>::quiet_NaN();

Status check(const MapCompareSettings& settings) {
  const bool thresholds = std::all_of(
      settings.thresholds.begin(), settings.thresholds.end(),
      [&](double threshold) { return threshold >= 0 && threshold < settings.max_distance_m; });
  if (thresholds && settings.max_distance_m > 0 && std::isfinite(settings.max_distance_m)) {
    return {};
  }
  std::string within;
  for (const double threshold : settings.thresholds) {
    within += fmt::format("{}{}", within.empty() ? "" : ", ", threshold);
  }
  return Error{ErrorCode::invalid_argument,
               fmt::format("distances up to {} m with shares within {}: give a limit above 0 and "
                           "thresholds below it",
                           settings.max_distance_m, within)};
}

Bounds bounds_of_returns(const Cloud& cloud) {
  Bounds box{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
  for (const Vec3& p : cloud.positions) {
    if (!is_return(p)) continue;
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

bool inside(const Bounds& box, const Vec3& p) {
  return p.x >= box.low.x && p.y >= box.low.y && p.z >= box.low.z && p.x <= box.high.x &&
         p.y <= box.high.y && p.z <= box.high.z;
}

/// Points that stand for the map.
Result<Cloud> points_of(const MapScene& scene, const Cloud& reference,
                        const MapCompareSettings& settings, std::size_t& count) {
  CURLIDAR_TRY_ASSIGN(
      all, map_points(scene.tiles(), settings.spacing_m, settings.max_points, settings.seed));
  count = all.seen();
  Cloud cloud = all.cloud();
  if (settings.crop) {
    const Bounds box = bounds_of_returns(reference);
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (inside(box, cloud.positions[i])) kept.push_back(static_cast<std::uint32_t>(i));
    }
    cloud = select(cloud, kept);
  }
  if (!cloud.positions.empty()) return cloud;
  return Error{ErrorCode::invalid_argument,
               count == 0 ? "the map has no surface to compare"
                          : "the map has no surface within the bounding box of the reference: are "
                            "both in one frame?"};
}

/// Capped; NaN where there is no distance.
std::vector<float> capped(const std::vector<double>& distances, double cap) {
  std::vector<float> errors;
  errors.reserve(distances.size());
  for (const double d : distances) {
    errors.push_back(std::isnan(d) ? kNoError : static_cast<float>(std::min(d, cap)));
  }
  return errors;
}

MapDistances summarise_errors(const std::vector<float>& errors,
                              const MapCompareSettings& settings) {
  std::vector<double> values;
  values.reserve(errors.size());
  for (const float e : errors) {
    if (!std::isnan(e)) values.push_back(e);
  }
  MapDistances summary;
  summary.count = values.size();
  summary.within.assign(settings.thresholds.size(), 0);
  if (values.empty()) return summary;
  const auto count = static_cast<double>(values.size());
  for (const double e : values) {
    summary.mean += e / count;
    summary.rms += e * e / count;
    summary.max = std::max(summary.max, e);
    summary.capped += e >= static_cast<float>(settings.max_distance_m) ? 1 : 0;
    for (std::size_t i = 0; i < settings.thresholds.size(); ++i) {
      summary.within[i] += e <= settings.thresholds[i] ? 1 : 0;
    }
  }
  summary.capped /= count;
  for (double& share : summary.within) share /= count;
  summary.rms = std::sqrt(summary.rms);
  summary.p50 = percentile(values, 0.5);
  summary.p95 = percentile(values, 0.95);
  return summary;
}

std::vector<float> surface_errors(const MapScene& scene, const Cloud& reference,
                                  const MapCompareSettings& settings) {
  std::vector<float> errors(reference.size(), kNoError);
  const std::size_t tasks = (reference.size() + kQueriesPerTask - 1) / kQueriesPerTask;
  parallel_for(tasks, settings.threads, [&](std::size_t task) {
    const std::size_t end = std::min(reference.size(), (task + 1) * kQueriesPerTask);
    for (std::size_t i = task * kQueriesPerTask; i < end; ++i) {
      if (!is_return(reference.positions[i])) continue;
      errors[i] =
          static_cast<float>(scene.distance(reference.positions[i], settings.max_distance_m));
    }
  });
  return errors;
}

}  // namespace

Result<MapComparison> compare_map(const MapScene& scene, const Cloud& reference,
                                  const MapCompareSettings& settings) {
  CURLIDAR_TRY(check(settings));
  if (count_returns(reference) == 0) {
    return Error{ErrorCode::invalid_argument, "the reference has no point to compare with"};
  }
  MapComparison result;
  CURLIDAR_TRY_ASSIGN(samples, points_of(scene, reference, settings, result.map_points));
  CURLIDAR_TRY_ASSIGN(to_reference, distances_to_nearest(samples, reference, settings.threads));
  CURLIDAR_TRY_ASSIGN(to_samples, distances_to_nearest(reference, samples, settings.threads));
  std::vector<float> errors = capped(to_reference, settings.max_distance_m);
  result.accuracy = summarise_errors(errors, settings);
  result.completeness_points =
      summarise_errors(capped(to_samples, settings.max_distance_m), settings);
  result.reference_errors = surface_errors(scene, reference, settings);
  result.completeness = summarise_errors(result.reference_errors, settings);
  for (std::size_t i = 0; i < settings.thresholds.size(); ++i) {
    const double p = result.accuracy.within[i], r = result.completeness.within[i];
    result.f_scores.push_back(p + r > 0 ? 2 * p * r / (p + r) : 0);
  }
  samples.attributes.insert(samples.attributes.begin(), {"error", 1, std::move(errors)});
  result.samples = std::move(samples);
  return result;
}

}  // namespace curlidar
