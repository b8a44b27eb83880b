// SPDX-License-Identifier: BSD-3-Clause
#include "mapfile/appended.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "map/tile_points.hpp"

namespace curlidar {
namespace {

using Cube = std::array<std::int64_t, 3>;

Cube cube_at(const Vec3& p, double edge_m) {
  const auto number = [&](double value) {
    return static_cast<std::int64_t>(std::floor(value / edge_m));
  };
  return {number(p.x), number(p.y), number(p.z)};
}

struct CubeHash {
  std::size_t operator()(const Cube& cube) const {
    std::uint64_t hash = 0;
    for (const std::int64_t number : cube) {
      hash = (hash ^ static_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return static_cast<std::size_t>(hash);
  }
};

double along(const Vec3& p, std::size_t axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/// Whether a point lies on a leaf's surface, within `near_m` of it and `beside_m` of a cell of its
/// footprint.
bool on_leaf(const MapTile& tile, const MapLeaf& leaf, const Vec3& p, double near_m,
             double beside_m) {
  const Vec3 d = p - leaf.centre;
  const double du = along(d, (leaf.axis + 1u) % 3), dv = along(d, (leaf.axis + 2u) % 3);
  const double half = leaf.size_m / 2;
  if (std::abs(du) > half + beside_m || std::abs(dv) > half + beside_m) return false;
  const double tilt = std::hypot(1, std::hypot(leaf.slope[0], leaf.slope[1]));
  if (std::abs(along(p, leaf.axis) - leaf_height(leaf, du, dv)) > near_m * tilt) return false;
  const double cell = leaf.size_m / leaf.cells;
  const auto last = static_cast<double>(leaf.cells - 1);
  const auto number = [&](double value) {
    return static_cast<std::size_t>(std::clamp(std::floor((value + half) / cell), 0.0, last));
  };
  for (std::size_t i = number(du - beside_m); i <= number(du + beside_m); ++i) {
    for (std::size_t j = number(dv - beside_m); j <= number(dv + beside_m); ++j) {
      if (tile.footprint[leaf.first_cell + i * leaf.cells + j] != 0) return true;
    }
  }
  return false;
}

/// The leaves of a tile by the cubes that they reach into.
class LeafIndex {
 public:
  LeafIndex(const MapTile& tile, double near_m, double beside_m)
      : tile_(tile), near_m_(near_m), beside_m_(beside_m) {
    const double reach = std::max(near_m, beside_m);
    for (std::size_t i = 0; i < tile.leaves.size(); ++i) {
      const MapLeaf& leaf = tile.leaves[i];
      const double half = leaf.size_m / 2 + reach;
      const Cube low = cube_at(leaf.centre - Vec3{half, half, half}, kEdge_m);
      const Cube high = cube_at(leaf.centre + Vec3{half, half, half}, kEdge_m);
      for (std::int64_t x = low[0]; x <= high[0]; ++x) {
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
          for (std::int64_t z = low[2]; z <= high[2]; ++z) {
            leaves_[{x, y, z}].push_back(static_cast<std::uint32_t>(i));
          }
        }
      }
    }
  }

  bool explains(const Vec3& p) const {
    const auto found = leaves_.find(cube_at(p, kEdge_m));
    if (found == leaves_.end()) return false;
    return std::any_of(found->second.begin(), found->second.end(), [&](std::uint32_t leaf) {
      return on_leaf(tile_, tile_.leaves[leaf], p, near_m_, beside_m_);
    });
  }

 private:
  static constexpr double kEdge_m = 2;
  const MapTile& tile_;
  double near_m_, beside_m_;
  std::unordered_map<Cube, std::vector<std::uint32_t>, CubeHash> leaves_;
};

/// Those that do not stand alone: `least` in their cube and the 26 around it.
std::vector<MapSample> not_alone(const std::vector<MapSample>& samples, double edge_m,
                                 std::size_t least) {
  std::unordered_map<Cube, std::size_t, CubeHash> count;
  for (const MapSample& sample : samples) ++count[cube_at(sample.position, edge_m)];
  std::vector<MapSample> kept;
  for (const MapSample& sample : samples) {
    const Cube middle = cube_at(sample.position, edge_m);
    std::size_t around = 0;
    for (std::int64_t k = 0; k < 27; ++k) {
      const auto found =
          count.find({middle[0] + k / 9 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k % 3 - 1});
      if (found != count.end()) around += found->second;
    }
    if (around >= least) kept.push_back(sample);
  }
  return kept;
}

}  // namespace

AppendedSamples appended_samples(const MapTile& old, const std::vector<MapSample>& added,
                                 const SurfaceSettings& settings) {
  // What the codec would leave out as too dear: samples that a bit of theirs saves less than it
  // costs. A leaf takes some 25 bits.
  constexpr double kLeafBits = 25;
  const double near_m = settings.drop_m;
  const auto least = static_cast<std::size_t>(
      std::max(8.0, kLeafBits * settings.metres_per_bit / settings.drop_m));
  const LeafIndex index(old, near_m, settings.footprint_m);
  AppendedSamples result;
  std::vector<MapSample> fresh;
  for (const MapSample& sample : added) {
    if (index.explains(sample.position)) {
      ++result.explained;
    } else {
      fresh.push_back(sample);
    }
  }
  fresh = not_alone(fresh, settings.footprint_m, least);
  if (fresh.empty()) return result;
  result.samples = tile_points(old, std::min(0.1, settings.footprint_m / 2));
  for (MapSample& sample : result.samples) sample.weight = kOldWeight;
  // Surfaces may leave their tile by a little; samples may not.
  const double most = std::nextafter(old.side_m, 0.0);
  for (MapSample& sample : result.samples) {
    sample.position.x = std::clamp(sample.position.x, 0.0, most);
    sample.position.y = std::clamp(sample.position.y, 0.0, most);
  }
  result.samples.insert(result.samples.end(), fresh.begin(), fresh.end());
  return result;
}

}  // namespace curlidar
