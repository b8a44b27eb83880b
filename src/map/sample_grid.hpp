// SPDX-License-Identifier: BSD-3-Clause
// Points seen many times, made few: one sample for each small cube.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/map_settings.hpp"

namespace curlidar {

/// Gathers the points of a tile. What it gives does not depend on the order in which points came.
/// 100 bytes or so for each cube that was hit.
class SampleGrid {
 public:
  explicit SampleGrid(double edge_m = 0.05) : edge_m_(edge_m) {}

  /// `position` from the tile's origin; false, and nothing added, beyond 2^20 cubes from it or if
  /// it is not finite. An intensity that is not finite is none.
  bool add(const Vec3& position, float intensity);

  std::size_t size() const { return cells_.size(); }
  bool empty() const { return cells_.empty(); }

  /// What is known of a cube; more of the same cube adds up exactly, in any order.
  struct Cell {
    std::uint32_t points = 0, with_intensity = 0;
    std::int64_t x = 0, y = 0, z = 0;  ///< sums, from the cube's corner, in 1/65536 of its edge
    double intensity = 0;              ///< sum of multiples of 2^-16
  };
  struct KeyedCell {
    std::uint64_t key = 0;
    Cell cell;
  };
  /// Cubes with their keys, in the order in which they were hit first.
  const std::vector<KeyedCell>& cells() const { return cells_; }
  /// Adds what another grid of the same edge knows of a cube.
  void add_cell(std::uint64_t key, const Cell& cell);

  /// One sample for each cube, at the mean of its points, sorted. Its weight grows with their
  /// number, but never above `kMostWeight`: to pass a street twice must not make it dear.
  std::vector<MapSample> samples() const;
  static constexpr float kMostWeight = 2;

 private:
  Cell& cell_of(std::uint64_t key);
  void widen();

  double edge_m_;
  std::vector<KeyedCell> cells_;
  /// Open addressing: places in cells_ plus 1, 0 where there is none; at most half are taken.
  std::vector<std::uint32_t> places_;
};

}  // namespace curlidar
