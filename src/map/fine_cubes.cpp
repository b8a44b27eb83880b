// SPDX-License-Identifier: BSD-3-Clause
#include "map/fine_cubes.hpp"

#include <algorithm>

namespace curlidar::tile {

FineCubes::FineCubes(const TileLayout& layout) : layout_(layout) {
  side_ = static_cast<std::int32_t>(layout.side_roots * layout.fine(0));
  height_ = static_cast<std::int32_t>(layout.rows * layout.fine(0));
  block_of_.assign(std::size_t{layout.side_roots} * layout.side_roots * layout.rows, kUnknown);
}

std::int32_t* FineCubes::block_of(std::size_t root) {
  const std::uint32_t log2 = 3 * layout_.levels;
  if (block_of_[root] < 0) {
    const std::int32_t before = block_of_[root];
    block_of_[root] = static_cast<std::int32_t>(blocks_.size() >> log2);
    blocks_.resize(blocks_.size() + (std::size_t{1} << log2), before);
  }
  return blocks_.data() + (static_cast<std::size_t>(block_of_[root]) << log2);
}

void FineCubes::fill(const TileCube& cube, std::int32_t value) {
  const std::uint32_t log2 = layout_.levels, f = layout_.fine(cube.level), mask = (1u << log2) - 1;
  const std::uint32_t x = cube.at[0] * f, y = cube.at[1] * f, z = cube.at[2] * f;
  const std::size_t root = root_at(x >> log2, y >> log2, z >> log2);
  if (cube.level == 0 && value < 0 && block_of_[root] < 0) {
    block_of_[root] = value;
    return;
  }
  std::int32_t* block = block_of(root);
  for (std::uint32_t i = 0; i < f; ++i) {
    for (std::uint32_t j = 0; j < f; ++j) {
      std::int32_t* row =
          block + ((((x & mask) + i) << log2 | ((y & mask) + j)) << log2 | (z & mask));
      std::fill(row, row + f, value);
    }
  }
}

bool FineCubes::any_leaf(const std::array<std::int32_t, 3>& low,
                         const std::array<std::int32_t, 3>& high) const {
  if (low[0] < 0 || low[1] < 0 || low[2] < 0) return false;
  if (low[0] >= side_ || low[1] >= side_ || low[2] >= height_) return false;
  std::array<std::uint32_t, 3> at{}, size{};
  for (std::size_t k = 0; k < 3; ++k) {
    at[k] = static_cast<std::uint32_t>(low[k]);
    size[k] = static_cast<std::uint32_t>(high[k] - low[k]);
  }
  const std::uint32_t log2 = layout_.levels, mask = (1u << log2) - 1;
  const std::int32_t number = block_of_[root_at(at[0] >> log2, at[1] >> log2, at[2] >> log2)];
  if (number < 0) return false;
  const std::int32_t* block = blocks_.data() + (static_cast<std::size_t>(number) << 3 * log2);
  for (std::uint32_t i = 0; i < size[0]; ++i) {
    for (std::uint32_t j = 0; j < size[1]; ++j) {
      const std::int32_t* row =
          block + ((((at[0] & mask) + i) << log2 | ((at[1] & mask) + j)) << log2 | (at[2] & mask));
      for (std::uint32_t k = 0; k < size[2]; ++k) {
        if (row[k] >= 0) return true;
      }
    }
  }
  return false;
}

void FineCubes::lay_on(const FineCubes& others) {
  const std::size_t cubes = std::size_t{1} << 3 * layout_.levels;
  for (std::size_t root = 0; root < block_of_.size(); ++root) {
    if (others.block_of_[root] < 0) continue;
    const std::int32_t* from =
        others.blocks_.data() + static_cast<std::size_t>(others.block_of_[root]) * cubes;
    std::int32_t* to = block_of(root);
    for (std::size_t k = 0; k < cubes; ++k) to[k] = from[k] >= 0 ? from[k] : to[k];
  }
}

}  // namespace curlidar::tile
