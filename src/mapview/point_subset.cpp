// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "curlidar/map_view.hpp"
#include "map/tile_points.hpp"
#include "mapview/leaf_shape.hpp"

namespace curlidar {
namespace {

/// A number that looks random for each point: the finaliser of SplitMix64 (Steele, Lea, Flood
/// 2014) of its place in the sequence.
std::uint64_t lot_of(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t x = index + 0x9e3779b97f4a7c15u * (seed + 1);
  for (int round = 0; round < 2; ++round) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    x ^= x >> 31;
  }
  return x;
}

}  // namespace

void PointSubset::add(const SurfacePoint& point) {
  if (!is_return(point.position)) return;
  const std::uint64_t lot = lot_of(seed_, seen_++);
  if (lot > limit_) return;
  points_.push_back(point);
  lots_.push_back(lot);
  // Half of the lots remain each time.
  while (points_.size() > capacity_) {
    limit_ /= 2;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < lots_.size(); ++i) {
      if (lots_[i] > limit_) continue;
      points_[kept] = points_[i], lots_[kept] = lots_[i];
      ++kept;
    }
    points_.resize(kept), lots_.resize(kept);
  }
}

Cloud PointSubset::cloud(bool normals) const {
  // A float tells a quarter of a millimetre up to here.
  constexpr double kFloatReach_m = 4096;
  Cloud cloud;
  std::vector<float> intensity;
  std::array<std::vector<float>, 3> normal;
  double largest = 0;
  bool any_intensity = false;
  for (const SurfacePoint& point : points_) {
    const Vec3& p = point.position;
    cloud.positions.push_back(p);
    intensity.push_back(point.intensity);
    any_intensity = any_intensity || !std::isnan(point.intensity);
    for (std::size_t k = 0; normals && k < 3; ++k) normal[k].push_back(point.normal[k]);
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  cloud.position_type = largest < kFloatReach_m ? ScalarType::float32 : ScalarType::float64;
  cloud.width = static_cast<std::uint32_t>(cloud.positions.size());
  if (any_intensity) cloud.attributes.push_back({"intensity", 1, std::move(intensity)});
  const char* names[] = {"normal_x", "normal_y", "normal_z"};
  for (std::size_t k = 0; normals && k < 3; ++k) {
    cloud.attributes.push_back({names[k], 1, std::move(normal[k])});
  }
  return cloud;
}

Result<PointSubset> map_points(const std::vector<MapTile>& tiles, double spacing_m,
                               std::size_t max_points, std::uint64_t seed) {
  constexpr double kFinest_m = 1e-3;
  if (!(spacing_m >= kFinest_m && std::isfinite(spacing_m)) || max_points == 0) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{} points on a map every {} m: give at least one, and a millimetre",
                             max_points, spacing_m)};
  }
  PointSubset subset(max_points, seed);
  std::vector<MapSample> points;
  for (const MapTile& tile : tiles) {
    for (const MapLeaf& leaf : tile.leaves) {
      points.clear();
      leaf_points(tile, leaf, spacing_m, points);
      if (points.empty()) continue;
      const LeafShape shape(tile, leaf, {}, 0);
      for (const MapSample& point : points) {
        const Vec3 normal = shape.normal(point.position);
        subset.add({tile.origin + point.position,
                    {static_cast<float>(normal.x), static_cast<float>(normal.y),
                     static_cast<float>(normal.z)},
                    point.intensity});
      }
    }
  }
  return subset;
}

}  // namespace curlidar
