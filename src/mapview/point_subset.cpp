// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>

#include "curlidar/map_view.hpp"
#include "map/tile_points.hpp"

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

void PointSubset::add(const Vec3& point, float value) {
  if (!is_return(point)) return;
  const std::uint64_t lot = lot_of(seed_, seen_++);
  if (lot > limit_) return;
  points_.push_back(point);
  values_.push_back(value);
  lots_.push_back(lot);
  // Half of the lots remain each time.
  while (points_.size() > capacity_) {
    limit_ /= 2;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < lots_.size(); ++i) {
      if (lots_[i] > limit_) continue;
      points_[kept] = points_[i], values_[kept] = values_[i], lots_[kept] = lots_[i];
      ++kept;
    }
    points_.resize(kept), values_.resize(kept), lots_.resize(kept);
  }
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
      for (const MapSample& point : points) {
        subset.add(tile.origin + point.position, point.intensity);
      }
    }
  }
  return subset;
}

}  // namespace curlidar
