// SPDX-License-Identifier: BSD-3-Clause
// What each finest cube of a tile holds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/tile_geometry.hpp"

namespace curlidar::tile {

/// What the finest cubes hold beside numbers of leaves.
inline constexpr std::int32_t kUnknown = -1, kEmpty = -2;

/// Numbers of leaves, kUnknown or kEmpty. Takes memory for roots that are not all the same.
class FineCubes {
 public:
  explicit FineCubes(const TileLayout& layout);

  /// kUnknown outside of the tile.
  std::int32_t at(std::int32_t x, std::int32_t y, std::int32_t z) const {
    if (x < 0 || y < 0 || z < 0 || x >= side_ || y >= side_ || z >= height_) return kUnknown;
    const auto ux = static_cast<std::uint32_t>(x), uy = static_cast<std::uint32_t>(y),
               uz = static_cast<std::uint32_t>(z);
    const std::uint32_t log2 = layout_.levels, mask = (1u << log2) - 1;
    const std::int32_t block = block_of_[root_at(ux >> log2, uy >> log2, uz >> log2)];
    if (block < 0) return block;
    const std::size_t inside = ((ux & mask) << log2 | (uy & mask)) << log2 | (uz & mask);
    return blocks_[(static_cast<std::size_t>(block) << 3 * log2) + inside];
  }
  void fill(const TileCube& cube, std::int32_t value);
  /// Whether a root, given by its place, may hold a leaf.
  bool may_hold(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return block_of_[root_at(x, y, z)] >= 0;
  }
  /// Whether a leaf is in a box of finest cubes [low, high), all of one root or outside.
  bool any_leaf(const std::array<std::int32_t, 3>& low,
                const std::array<std::int32_t, 3>& high) const;
  /// Takes what others hold where they hold leaves.
  void lay_on(const FineCubes& others);
  /// Memory taken so far, in finest cubes.
  std::size_t size() const { return blocks_.size(); }

 private:
  std::size_t root_at(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::size_t{x} * layout_.side_roots + y) * layout_.rows + z;
  }
  std::int32_t* block_of(std::size_t root);

  TileLayout layout_;
  std::int32_t side_ = 0, height_ = 0;  ///< of the tile, in finest cubes
  std::vector<std::int32_t> block_of_;  ///< of roots; kUnknown and kEmpty without a block
  std::vector<std::int32_t> blocks_;
};

}  // namespace curlidar::tile
