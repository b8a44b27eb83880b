// SPDX-License-Identifier: BSD-3-Clause
// The residual layer: ranges of one segment on top of its decoded field, to any step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.hpp"

namespace curlidar::compact {

/// Decoded ranges lie in [1, kMaxRangeQ16], in 1/65536 m.
inline constexpr std::int32_t kMaxRangeQ16 = 1 << 30;

/// What encoder and decoder both know of a segment before its residuals. All spans hold
/// rows * columns entries, row-major; what they hold in empty cells does not matter.
struct ResidualSegment {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::span<const std::uint8_t> occupied;  ///< whether the cell has a range
  std::span<const std::uint8_t> coded;     ///< whether its leaf has residuals; else field = range
  std::span<const std::int32_t> field;     ///< range that the field predicts, 1/65536 m
  std::span<const std::int32_t> surface;   ///< equal for the cells of one layer of one leaf
};

/// The levels that a range may decode to.
struct ResidualLevels {
  /// Their distance in 1/65536 m, in [1, 2^24]; one of them lies on the prediction.
  std::int32_t step = 1;
  /// If not zero, in [2^16, 2^40]: the levels are the multiples of this many 1/2^32 m instead, and
  /// `step` is ignored. For ranges that are multiples of a sensor's unit: at a lattice of that unit
  /// they decode exactly, at no more bits than any other levels as far apart.
  std::uint64_t lattice_q32 = 0;
};

/// What an encoder balances.
struct ResidualBalance {
  /// What a bit is worth, in 1/256 of 1/65536 m; 0 takes the nearest level, and then
  /// |decoded - range| of every coded cell is at most half a step, or half a lattice distance and
  /// half of 1/65536 m.
  std::uint32_t lambda = 0;
  /// If not 0: levels farther off than this (1/65536 m) are taken only where none is nearer.
  std::int32_t max_error = 0;
};

/// Codes `ranges` (1/65536 m, in [1, kMaxRangeQ16]) and gives the bytes; `decoded` receives what
/// decode_residual will give (0 in empty cells). O(cells).
std::vector<std::byte> encode_residual(const ResidualSegment& segment,
                                       std::span<const std::int32_t> ranges,
                                       const ResidualLevels& levels, const ResidualBalance& balance,
                                       std::span<std::int32_t> decoded);

/// Decodes what encode_residual wrote and returns how many rows are complete. Any bytes decode to
/// something. Where bytes are missing, which `cut` says or decoding finds out, the rows that depend
/// on them hold their field.
std::size_t decode_residual(ByteSpan bytes, const ResidualSegment& segment,
                            const ResidualLevels& levels, std::span<std::int32_t> decoded,
                            bool cut = false);

}  // namespace curlidar::compact
