// SPDX-License-Identifier: BSD-3-Clause
// A tile of a surface map: any bytes decode to leaves within bounds or to an error, at every level.
#pragma once

#include <cmath>
#include <string>

#include "hostile/targets/input.hpp"
#include "map/surface_tile.hpp"
#include "map/tile_points.hpp"

namespace curlidar::test {

inline std::string check_tile(const MapTile& tile, const TileLimits& limits) {
  if (tile.leaves.size() > limits.max_leaves) return "more leaves than allowed";
  for (const MapLeaf& leaf : tile.leaves) {
    if (leaf.axis > 2 || leaf.cells == 0 || !(leaf.size_m > 0)) return "a leaf that is none";
    if (leaf.first_cell + std::size_t{leaf.cells} * leaf.cells > tile.footprint.size()) {
      return "a footprint that is not there";
    }
    if (!(leaf.centre.x > 0 && leaf.centre.x < tile.side_m && leaf.centre.y > 0 &&
          leaf.centre.y < tile.side_m)) {
      return "a leaf outside of its tile";
    }
    if (!std::isfinite(leaf.height_m) || !(std::abs(leaf.slope[0]) < 100) ||
        !(std::abs(leaf.slope[1]) < 100)) {
      return "a plane without bounds";
    }
  }
  for (const std::uint8_t cell : tile.footprint) {
    if (cell > 1) return "a cell that is neither";
  }
  return "";
}

/// Input: a level (byte), the tile.
inline std::string surface_target(ByteSpan bytes) {
  FuzzInput input(bytes);
  const std::uint32_t level = input.byte();
  const ByteSpan coded = input.rest();
  constexpr TileLimits kLimits{.max_leaves = 4000, .max_cells = std::size_t{1} << 18};
  const Result<MapTile> tile = decode_surface_tile(coded, kLimits);
  const Result<MapTile> coarse = decode_surface_tile(coded, kLimits, level);
  if (tile.has_value() != coarse.has_value()) return "one level decodes and another does not";
  if (!tile) return tile.error().message.empty() ? "an error without words" : "";
  if (std::string fault = check_tile(*tile, kLimits); !fault.empty()) return fault;
  if (coarse->leaves.size() > tile->leaves.size()) return "a coarser level has more leaves";
  return check_tile(*coarse, kLimits);
}

}  // namespace curlidar::test
