// SPDX-License-Identifier: BSD-3-Clause
// Which cells of a segment hold a return: a two-valued image, coded losslessly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.hpp"
#include "compact/prediction_guide.hpp"

namespace curlidar::compact {

/// The size of a segment's mask. It is coded alone: nothing outside the segment matters.
struct MaskShape {
  std::size_t rows = 0;          ///< rings, top to bottom
  std::size_t columns = 0;       ///< of the segment
  std::size_t turn_columns = 0;  ///< of the full turn; a segment of that many closes on itself
};

/// Codes a mask: `occupied` holds rows * columns flags (0 = empty), row-major. `thorough` tries
/// every way the format has of learning from what comes and keeps the shortest, which takes four
/// times as long and gains where masks resemble nothing the priors know. `guide`: of predicted
/// scans. O(cells).
std::vector<std::byte> encode_mask(std::span<const std::uint8_t> occupied, const MaskShape& shape,
                                   bool thorough, const Guide* guide = nullptr);

/// Decodes what encode_mask wrote into rows * columns flags, 0 or 1. Any bytes decode to something
/// in O(cells). `whole` says that no bytes are missing at the end; of bytes cut short, only the
/// rows before the returned one (in [0, rows]) are sure, and the others come out empty. Of whole
/// bytes all rows count, unless the bytes are not an encoder's and end too early.
std::size_t decode_mask(ByteSpan bytes, const MaskShape& shape, bool whole,
                        std::span<std::uint8_t> occupied, const Guide* guide = nullptr,
                        LearntModels* learnt = nullptr);

}  // namespace curlidar::compact
