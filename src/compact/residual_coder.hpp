// SPDX-License-Identifier: BSD-3-Clause
// The residual layer: ranges of one segment on top of its decoded field, to any step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.hpp"

namespace curlidar {

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

/// Codes `ranges` (1/65536 m) to multiples of `step` (1/65536 m, in [1, 2^24]) about predictions
/// and gives the bytes; `decoded` receives what decode_residual will give (0 in empty cells).
/// `lambda` is what a bit is worth, in 1/256 of 1/65536 m; 0 rounds to the nearest level, and then
/// every |decoded - range| of a coded cell is at most step / 2, ranges in [1, kMaxRangeQ16].
/// O(cells), about 1 us a coded cell.
std::vector<std::byte> encode_residual(const ResidualSegment& segment,
                                       std::span<const std::int32_t> ranges, std::int32_t step,
                                       std::uint32_t lambda, std::span<std::int32_t> decoded);

/// Decodes what encode_residual wrote. Any bytes decode to something; of bytes that end too early,
/// the rows before the returned one (in [0, rows]) are complete, and later cells hold their field.
std::size_t decode_residual(ByteSpan bytes, const ResidualSegment& segment, std::int32_t step,
                            std::span<std::int32_t> decoded);

}  // namespace curlidar
