// SPDX-License-Identifier: BSD-3-Clause
// The mask of a segment: any bytes decode to flags, and what they decode to can be coded again.
#pragma once

#include <algorithm>
#include <string>

#include "compact/mask_coder.hpp"
#include "hostile/targets/input.hpp"

namespace curlidar::test {

/// Input: rows - 1, columns - 1, options (1: whole, 2 and 4: size of the turn), payload.
inline std::string mask_target(ByteSpan bytes) {
  FuzzInput input(bytes);
  const std::size_t rows = 1 + input.byte() % 64, columns = 1 + input.byte() % 96;
  const std::uint32_t options = input.byte();
  const bool whole = (options & 1) != 0;
  const std::size_t turns[] = {columns, 2 * columns, 2048, std::size_t{1} << 22};
  const compact::MaskShape shape{rows, columns, turns[options >> 1 & 3]};

  std::vector<std::uint8_t> mask(rows * columns, 7);
  const std::size_t sure = compact::decode_mask(input.rest(), shape, whole, mask);
  if (sure > rows) return "more rows than there are";
  for (std::size_t cell = 0; cell < mask.size(); ++cell) {
    if (mask[cell] > 1) return "a flag that is neither 0 nor 1";
    if (cell >= sure * columns && mask[cell] != 0) return "a return in a row that is not known";
  }
  const std::vector<std::byte> coded = compact::encode_mask(mask, shape, false);
  std::vector<std::uint8_t> again(mask.size());
  if (compact::decode_mask(coded, shape, true, again) != rows || again != mask) {
    return "coded again, the mask differs";
  }
  return "";
}

}  // namespace curlidar::test
