// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "base/try.hpp"
#include "cloud/neighbours.hpp"
#include "metrics/planes.hpp"

namespace curlidar {
namespace {

Status check(const MetricsSettings& settings) {
  const auto refuse = [](std::string message) {
    return Error{ErrorCode::invalid_argument, std::move(message)};
  };
  for (const double threshold : settings.thresholds) {
    if (!(threshold >= 0)) return refuse(fmt::format("a threshold of {} m: at least 0", threshold));
  }
  if (!(settings.peak > 0) || !std::isfinite(settings.peak)) {
    return refuse(fmt::format("a peak of {} m: above 0 and finite", settings.peak));
  }
  if (settings.normal_neighbours < 3) {
    return refuse(fmt::format("normals from {} neighbours: a plane needs at least 3",
                              settings.normal_neighbours));
  }
  if (settings.quantiles == 1) return refuse("1 quantile: at least 2, the least and the largest");
  return {};
}

std::vector<double> distances_of(const std::vector<Neighbour>& nearest) {
  std::vector<double> distances;
  distances.reserve(nearest.size());
  for (const Neighbour& n : nearest) {
    if (!std::isnan(n.distance)) distances.push_back(n.distance);
  }
  return distances;
}

double mean_squared(const std::vector<double>& distances) {
  double sum = 0;
  for (const double d : distances) sum += d * d;
  return sum / static_cast<double>(distances.size());
}

GeometryError geometry_error(double a_to_b_mse, double b_to_a_mse, double peak) {
  const double mse = std::max(a_to_b_mse, b_to_a_mse);
  return {a_to_b_mse, b_to_a_mse, mse, std::sqrt(mse), psnr(mse, peak)};
}

double harmonic_mean(double a, double b) {
  return a + b > 0 ? 2 * a * b / (a + b) : 0;
}

double ratio(std::size_t part, std::size_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// The cubes that hold returns, each once, in order. Indices are whole numbers in doubles, which no
/// coordinate overflows.
using Cube = std::array<double, 3>;
std::vector<Cube> occupied_cubes(const Cloud& cloud, const Vec3& origin, double voxel) {
  std::vector<Cube> cubes;
  cubes.reserve(cloud.size());
  for (const Vec3& p : cloud.positions) {
    if (!is_return(p)) continue;
    const Vec3 d = p - origin;
    cubes.push_back({std::floor(d.x / voxel), std::floor(d.y / voxel), std::floor(d.z / voxel)});
  }
  std::sort(cubes.begin(), cubes.end());
  cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
  return cubes;
}

}  // namespace

double psnr(double mse, double peak) {
  return 10 * std::log10(3 * peak * peak / mse);
}

double share_within(const std::vector<double>& distances, double threshold) {
  std::size_t within = 0;
  std::size_t count = 0;
  for (const double d : distances) {
    if (std::isnan(d)) continue;
    ++count;
    if (d <= threshold) ++within;
  }
  return count > 0 ? ratio(within, count) : 0;
}

std::vector<double> quantiles(std::vector<double> distances, std::size_t count) {
  std::erase_if(distances, [](double d) { return std::isnan(d); });
  std::vector<double> values;
  if (distances.empty() || count < 2) return values;
  std::sort(distances.begin(), distances.end());
  const std::size_t last = distances.size() - 1;
  values.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double at = ratio(i, count - 1) * static_cast<double>(last);
    const auto below = static_cast<std::size_t>(at);
    const double part = at - static_cast<double>(below);
    const double next = distances[std::min(below + 1, last)];
    values.push_back(distances[below] + part * (next - distances[below]));
  }
  return values;
}

Result<VoxelOverlap> voxel_overlap(const Cloud& a, const Cloud& b, double voxel) {
  if (!(voxel > 0) || !std::isfinite(voxel)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("voxels of {} m: above 0 and finite", voxel)};
  }
  if (count_returns(a) == 0 || count_returns(b) == 0) {
    return Error{ErrorCode::invalid_argument, "cannot compare voxels of a cloud without a return"};
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 origin{kInfinity, kInfinity, kInfinity};
  for (const Cloud* cloud : {&a, &b}) {
    for (const Vec3& p : cloud->positions) {
      if (!is_return(p)) continue;
      origin = {std::min(origin.x, p.x), std::min(origin.y, p.y), std::min(origin.z, p.z)};
    }
  }
  const std::vector<Cube> cubes_a = occupied_cubes(a, origin, voxel);
  const std::vector<Cube> cubes_b = occupied_cubes(b, origin, voxel);
  std::vector<Cube> both;
  std::set_intersection(cubes_a.begin(), cubes_a.end(), cubes_b.begin(), cubes_b.end(),
                        std::back_inserter(both));
  VoxelOverlap overlap{voxel, cubes_a.size(), cubes_b.size(), both.size()};
  overlap.iou = ratio(both.size(), cubes_a.size() + cubes_b.size() - both.size());
  overlap.precision = ratio(both.size(), cubes_b.size());
  overlap.recall = ratio(both.size(), cubes_a.size());
  overlap.f1 = harmonic_mean(overlap.precision, overlap.recall);
  return overlap;
}

Result<Metrics> measure(const Cloud& a, const Cloud& b, const MetricsSettings& settings,
                        std::size_t threads) {
  CURLIDAR_TRY(check(settings));
  CURLIDAR_TRY_ASSIGN(from_a, nearest_returns(a, b, threads));
  CURLIDAR_TRY_ASSIGN(from_b, nearest_returns(b, a, threads));
  CURLIDAR_TRY_ASSIGN(voxels, voxel_overlap(a, b, settings.voxel));
  const std::vector<double> a_to_b = distances_of(from_a);
  const std::vector<double> b_to_a = distances_of(from_b);

  Metrics metrics;
  metrics.directed = {a_to_b.size(), b_to_a.size(), summarise(a_to_b), summarise(b_to_a)};
  const DistanceStats& forth = metrics.directed.a_to_b;
  const DistanceStats& back = metrics.directed.b_to_a;
  metrics.symmetric_mean = std::max(forth.mean, back.mean);
  metrics.symmetric_rms = std::max(forth.rms, back.rms);
  metrics.chamfer = (forth.mean + back.mean) / 2;
  metrics.point_to_point =
      geometry_error(mean_squared(a_to_b), mean_squared(b_to_a), settings.peak);
  metrics.chamfer_squared = metrics.point_to_point.a_to_b_mse + metrics.point_to_point.b_to_a_mse;
  for (const double threshold : settings.thresholds) {
    const double precision = share_within(b_to_a, threshold);
    const double recall = share_within(a_to_b, threshold);
    metrics.matches.push_back({threshold, precision, recall, harmonic_mean(precision, recall)});
  }
  if (settings.planes) {
    const std::vector<Vec3> normals = surface_normals(a, settings.normal_neighbours, threads);
    const PlaneErrors errors = plane_errors(a, b, normals, from_a, from_b);
    metrics.point_to_plane = geometry_error(errors.a_to_b, errors.b_to_a, settings.peak);
    metrics.normals_given = has_normals(a);
  }
  metrics.voxels = voxels;
  metrics.quantiles_a_to_b = quantiles(a_to_b, settings.quantiles);
  metrics.quantiles_b_to_a = quantiles(b_to_a, settings.quantiles);
  return metrics;
}

}  // namespace curlidar
