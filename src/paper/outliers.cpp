// SPDX-License-Identifier: BSD-3-Clause
#include "paper/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>

namespace curlidar {
namespace {

constexpr double kFarthestCube = 1e9;

/// Integer coordinates of a cube of the grid.
struct Cube {
  std::int32_t x = 0, y = 0, z = 0;
  friend bool operator==(const Cube&, const Cube&) = default;
};

/// Cubes that stand for everything beyond kFarthestCube; no sensor sees that far.
bool is_outermost(const Cube& c) {
  const auto limit = static_cast<std::int32_t>(kFarthestCube);
  return std::abs(c.x) >= limit || std::abs(c.y) >= limit || std::abs(c.z) >= limit;
}

std::uint64_t hash_of(const Cube& c) {
  std::uint64_t h = static_cast<std::uint32_t>(c.x) * 0x9E3779B97F4A7C15ull;
  h ^= static_cast<std::uint32_t>(c.y) * 0xC2B2AE3D27D4EB4Full + (h << 6) + (h >> 2);
  h ^= static_cast<std::uint32_t>(c.z) * 0x165667B19E3779F9ull + (h << 6) + (h >> 2);
  return h ^ (h >> 29);
}

/// Returns bucketed into cubes: an open-addressing table, each slot a run of `points_`.
class CubeGrid {
 public:
  CubeGrid(const std::vector<Vec3>& positions, double edge) : inverse_edge_(1 / edge) {
    std::vector<std::uint32_t> returns;
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      if (is_return(positions[i])) returns.push_back(i);
    }
    std::size_t capacity = 16;
    while (capacity < returns.size() * 2) capacity *= 2;
    slots_.resize(capacity);
    std::vector<std::size_t> slot_of_return(returns.size());
    for (std::size_t j = 0; j < returns.size(); ++j) {
      const Cube cube = cube_of(positions[returns[j]]);
      const std::size_t s = locate(cube);
      slots_[s].cube = cube;
      ++slots_[s].count;
      slot_of_return[j] = s;
    }
    std::uint32_t end = 0;
    for (Slot& slot : slots_) slot.begin = end += slot.count;  // walks down while filling
    points_.resize(returns.size());
    for (std::size_t j = returns.size(); j-- > 0;) {
      points_[--slots_[slot_of_return[j]].begin] = returns[j];
    }
  }

  /// Empty if no return lies in the cube.
  std::span<const std::uint32_t> points_in(const Cube& cube) const { return run(locate(cube)); }

  /// Calls visit(cube, points) for every occupied cube.
  template <class Visit>
  void for_each_cube(const Visit& visit) const {
    for (std::size_t s = 0; s < slots_.size(); ++s) {
      if (slots_[s].count > 0) visit(slots_[s].cube, run(s));
    }
  }

 private:
  struct Slot {
    Cube cube;
    std::uint32_t begin = 0, count = 0;
  };

  Cube cube_of(const Vec3& p) const {
    const auto index = [&](double v) {
      return static_cast<std::int32_t>(
          std::clamp(std::floor(v * inverse_edge_), -kFarthestCube, kFarthestCube));
    };
    return {index(p.x), index(p.y), index(p.z)};
  }
  std::size_t locate(const Cube& cube) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t s = static_cast<std::size_t>(hash_of(cube)) & mask;
    while (slots_[s].count > 0 && !(slots_[s].cube == cube)) s = (s + 1) & mask;
    return s;
  }
  std::span<const std::uint32_t> run(std::size_t s) const {
    return {points_.data() + slots_[s].begin, slots_[s].count};
  }

  double inverse_edge_;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> points_;
};

/// Whether at least `needed` points lie within the radius of `p`; looks no further than needed.
bool has_neighbours(const CubeGrid& grid, const std::vector<Vec3>& positions, const Cube& centre,
                    const Vec3& p, double radius2, int reach, std::uint32_t needed) {
  std::uint32_t found = 0;
  for (int dz = -reach; dz <= reach; ++dz) {
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        for (const std::uint32_t j :
             grid.points_in({centre.x + dx, centre.y + dy, centre.z + dz})) {
          const Vec3 d = positions[j] - p;
          if (dot(d, d) <= radius2 && ++found >= needed) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace

std::vector<bool> find_inliers(const Cloud& cloud, double radius_m, std::uint32_t min_points) {
  std::vector<bool> keep(cloud.size(), false);
  if (radius_m <= 0 || min_points <= 1) {
    for (std::size_t i = 0; i < cloud.size(); ++i) keep[i] = is_return(cloud.positions[i]);
    return keep;
  }
  // The diagonal of a cube is just under the radius: points of one cube are all neighbours.
  const double edge = radius_m / std::sqrt(3.0) * (1 - 1e-9);
  const int reach = static_cast<int>(std::ceil(radius_m / edge));
  const CubeGrid grid(cloud.positions, edge);
  grid.for_each_cube([&](const Cube& cube, std::span<const std::uint32_t> points) {
    if (is_outermost(cube)) return;
    const bool settled = points.size() >= min_points;
    for (const std::uint32_t i : points) {
      keep[i] = settled || has_neighbours(grid, cloud.positions, cube, cloud.positions[i],
                                          radius_m * radius_m, reach, min_points);
    }
  });
  return keep;
}

}  // namespace curlidar
