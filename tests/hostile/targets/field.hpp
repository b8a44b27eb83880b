// SPDX-License-Identifier: BSD-3-Clause
// The field of a segment: any bytes decode to bounded surfaces, and what they decode to can be
// written again.
#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "compact/field_encoder.hpp"
#include "entropy/range_coder.hpp"
#include "hostile/targets/input.hpp"

namespace curlidar::test {

/// Rows of a segment as the target makes them up: evenly spaced, from pole to pole, all alike, or
/// without order.
enum class Rows : std::uint8_t { even, steep, alike, scattered };

inline std::vector<std::int32_t> made_up_elevations(std::uint32_t rows, Rows kind) {
  constexpr std::int64_t quarter = std::int64_t{1} << 30;
  std::vector<std::int32_t> elevations;
  for (std::uint32_t row = 0; row < rows; ++row) {
    std::int64_t e = std::int64_t{1} << 26;
    if (kind == Rows::even) e -= std::int64_t{row} * (std::int64_t{5} << 26) / rows;
    if (kind == Rows::steep) e = quarter - 2 * quarter * row / std::max(rows - 1, 1u);
    if (kind == Rows::scattered) e = static_cast<std::int64_t>(mixed(row)) / 2 - quarter;
    elevations.push_back(static_cast<std::int32_t>(e));
  }
  return elevations;
}

struct FieldInput {
  compact::FieldSettings settings;
  compact::Geometry geometry;
  std::vector<std::uint8_t> occupied;
  bool whole = true;
  ByteSpan payload;
};

/// Input: step - 1 (3 bytes), root_log2 - 1, smallest leaf - 1 (2 bytes), rows - 1, columns - 1,
/// kinds (bits 0-1: of rows, 2-3: of turn, 4-5: of mask, 6: cut off), mask where it is given,
/// payload.
inline FieldInput field_input(ByteSpan bytes) {
  FuzzInput input(bytes);
  compact::FieldSettings settings;
  settings.step = static_cast<std::int32_t>(1 + input.three_bytes());
  settings.root_log2 = 1 + input.byte() % 5;
  settings.smallest_leaf = 1 + input.two_bytes() % 1024;
  const std::uint32_t rows = 1 + input.byte() % 40, columns = 1 + input.byte() % 72;
  const std::uint32_t kinds = input.byte();
  const std::uint32_t turns[] = {columns, 2 * columns, 1024, 1u << 22};
  const std::uint32_t turn = turns[kinds >> 2 & 3];
  compact::Geometry geometry(made_up_elevations(rows, static_cast<Rows>(kinds & 3)), turn,
                             turn - columns, columns);
  auto occupied = fill_flags(input, geometry.cells(), static_cast<Fill>(kinds >> 4 & 3));
  return {settings, std::move(geometry), std::move(occupied), (kinds & 64) == 0, input.rest()};
}

inline std::string check_field(const compact::FieldState& state) {
  const auto surfaces = static_cast<std::int64_t>(state.surfaces.size());
  if (state.surfaces.size() > state.geometry.cells()) return "more surfaces than cells";
  for (std::size_t cell = 0; cell < state.surface.size(); ++cell) {
    const std::int32_t surface = state.surface[cell];
    if (surface == compact::kNoSurface) continue;
    if (surface < 0 || surface >= surfaces) return "a cell on a surface that is not there";
    if (state.occupied[cell] == 0) return "an empty cell on a surface";
    if (state.range[cell] < compact::kMinRange || state.range[cell] > compact::kMaxRange) {
      return "a range out of bounds";
    }
  }
  return "";
}

inline std::string field_target(ByteSpan bytes) {
  using namespace compact;
  const FieldInput input = field_input(bytes);
  FieldState state(input.geometry, input.occupied, input.settings);
  DecodedField field = decode_field(state, input.payload, input.whole);
  if (std::string fault = check_field(state); !fault.empty()) return fault;
  const std::size_t roots = roots_of(input.geometry, input.settings).size();
  if (field.complete_roots > roots) return "more roots than there are";
  if (field.complete_roots < roots) return "";

  FieldState written(input.geometry, input.occupied, input.settings);
  RangeEncoder encoder;
  FieldModels models;
  MixSink<RangeEncoder> sink(encoder, models);
  for (Node& node : field.roots) code_node(sink, written, node);
  if (written.range != state.range || written.surface != state.surface) {
    return "written again, the field differs";
  }
  FieldState again(input.geometry, input.occupied, input.settings);
  const std::vector<std::byte> coded = std::move(encoder).finish();
  if (decode_field(again, coded, true).complete_roots != roots || again.range != state.range ||
      again.surface != state.surface) {
    return "written and read again, the field differs";
  }
  return "";
}

}  // namespace curlidar::test
