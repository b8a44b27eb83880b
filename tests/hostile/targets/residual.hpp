// SPDX-License-Identifier: BSD-3-Clause
// The residual layer of a segment: any bytes decode to ranges, and what an encoder says that they
// decode to is what they decode to.
#pragma once

#include <string>

#include "compact/residual_coder.hpp"
#include "hostile/targets/input.hpp"

namespace curlidar::test {

struct ResidualInput {
  std::size_t rows = 0, columns = 0;
  compact::ResidualLevels levels;
  bool cut = false;
  std::uint32_t lambda = 0;  ///< of the encoder
  std::vector<std::uint8_t> occupied, coded;
  std::vector<std::int32_t> field, surface;
  ByteSpan payload;

  compact::ResidualSegment segment() const {
    return {rows, columns, occupied, coded, field, surface};
  }
};

/// The field as the target makes it up: kind 0 is level, 1 a ramp, 2 and 3 jump up and down, 3 from
/// one end of what 32 bits hold to the other.
inline std::int32_t made_up_field(std::uint32_t kind, std::size_t row, std::size_t column) {
  const std::size_t cell = row * 64 + column;
  if (kind == 0) return 10 << 16;
  if (kind == 1) return static_cast<std::int32_t>((5 << 16) + row * 9001 + column * 1237);
  if (kind == 2) return static_cast<std::int32_t>(mixed(cell) >> 4);
  return static_cast<std::int32_t>(mixed(cell));
}

/// Input: rows - 1, columns - 1, kinds (bits 0-1: field, 2-3: mask, 4-5: which leaves have
/// residuals, 6: cut off, 7: levels on a lattice), step - 1 or lattice / 2^16 (3 bytes), columns of
/// a surface - 1 (bit 7: the encoder weighs bits), masks where they are given, payload.
inline ResidualInput residual_input(ByteSpan bytes) {
  FuzzInput input(bytes);
  ResidualInput out;
  out.rows = 1 + input.byte() % 24;
  out.columns = 1 + input.byte() % 64;
  const std::uint32_t kinds = input.byte();
  const std::uint32_t step = 1 + input.three_bytes();
  out.levels.step = static_cast<std::int32_t>(step);
  if ((kinds & 128) != 0) out.levels.lattice_q32 = std::uint64_t{step} << 16;
  const std::uint32_t last = input.byte();
  const std::size_t width = 1 + last % 16;
  out.lambda = (last & 128) != 0 ? 4000 : 0;
  const std::size_t cells = out.rows * out.columns;
  out.occupied = fill_flags(input, cells, static_cast<Fill>(kinds >> 2 & 3));
  out.coded = fill_flags(input, cells, static_cast<Fill>(kinds >> 4 & 3));
  out.cut = (kinds & 64) != 0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const std::size_t row = cell / out.columns, column = cell % out.columns;
    out.field.push_back(made_up_field(kinds & 3, row, column));
    out.surface.push_back(static_cast<std::int32_t>(row / 8 * 16 + column / width));
  }
  out.payload = input.rest();
  return out;
}

inline std::string residual_target(ByteSpan bytes) {
  using namespace compact;
  const ResidualInput input = residual_input(bytes);
  const std::size_t cells = input.occupied.size();
  std::vector<std::int32_t> decoded(cells, -1);
  const std::size_t sure =
      decode_residual(input.payload, input.segment(), input.levels, decoded, input.cut);
  if (sure > input.rows) return "more rows than there are";
  for (std::size_t cell = 0; cell < cells; ++cell) {
    if (input.occupied[cell] == 0 ? decoded[cell] != 0
                                  : decoded[cell] < 1 || decoded[cell] > kMaxRangeQ16) {
      return "a range out of bounds";
    }
  }
  std::vector<std::int32_t> coded(cells), again(cells);
  const std::vector<std::byte> payload =
      encode_residual(input.segment(), decoded, input.levels, {input.lambda}, coded);
  const std::size_t rows = decode_residual(payload, input.segment(), input.levels, again, false);
  if (rows != input.rows || again != coded) return "coded again, the ranges differ";
  return "";
}

}  // namespace curlidar::test
