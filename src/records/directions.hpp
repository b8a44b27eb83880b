// SPDX-License-Identifier: BSD-3-Clause
// Chunk `directions`: where returns lie beside the middles of their cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curlidar/result.hpp"
#include "format/container.hpp"
#include "records/grid.hpp"

namespace curlidar {

/// From the direction of a cell's middle to that of its return: binary angles (2^32 to a turn).
struct DirectionOffset {
  std::int32_t across = 0;  ///< along the row, positive towards larger azimuths
  std::int32_t up = 0;

  friend bool operator==(const DirectionOffset&, const DirectionOffset&) = default;
};

struct CodedDirections {
  std::vector<std::byte> bytes;
  std::vector<DirectionOffset> decoded;  ///< of each occupied cell, in raster order
};

/// One step of an offset at a range (> 0, Q16 metres), a binary angle:
/// max(1, floor(step * 683565276 / range)), 683565276 = round(2^32 / 2 pi).
std::int64_t direction_step(std::int32_t range, std::int32_t step);

/// Codes offsets to the nearest multiple of direction_step(range, step): within step / 2 in either
/// direction at the point, or better. `ranges` (Q16 metres, 1 .. 2^30, as decoded) and `offsets`
/// have one entry for every occupied cell, in raster order; step is 1 .. 2^30, Q16 metres. Loose
/// points have no part in it. O(rows * columns).
CodedDirections encode_directions(const CellGrid& grid, std::span<const std::int32_t> ranges,
                                  std::span<const DirectionOffset> offsets, std::int32_t step);

/// Reads what encode_directions wrote for the same grid and ranges. Errors: corrupt.
Result<std::vector<DirectionOffset>> decode_directions(const Chunk& chunk, const CellGrid& grid,
                                                       std::span<const std::int32_t> ranges);

}  // namespace curlidar
