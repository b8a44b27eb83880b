// SPDX-License-Identifier: BSD-3-Clause
#include "compact/leaf_flags.hpp"

#include <array>

#include "entropy/model.hpp"

namespace curlidar::compact {
namespace {

constexpr std::uint32_t kUnknown = 2;
constexpr std::uint32_t kLimit = 255;

template <class Coder, class Leaf>
void code_flags(Coder& coder, const FieldState& state, std::vector<Leaf>& leaves,
                const std::vector<std::int32_t>& leaf_of_cell) {
  std::array<BitModel, 9> models;
  const auto flag_at = [&](std::int64_t row, std::int64_t column) -> std::uint32_t {
    if (state.surface_at(row, column) == kNoSurface) return kUnknown;
    const auto cell =
        state.cell(static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column));
    return leaves[static_cast<std::size_t>(leaf_of_cell[cell])].has_residual ? 1 : 0;
  };
  for (Leaf& leaf : leaves) {
    const Block& b = leaf.block;
    const std::uint32_t left = flag_at(b.row + b.height / 2, std::int64_t{b.column} - 1);
    const std::uint32_t above = flag_at(std::int64_t{b.row} - 1, b.column + b.width / 2);
    leaf.has_residual = code_bit(coder, models[left * 3 + above], kLimit, leaf.has_residual);
  }
}

bool same_block(const Block& a, const Block& b) {
  return a.row == b.row && a.column == b.column && a.height == b.height && a.width == b.width;
}

}  // namespace

std::vector<DecodedLeaf> leaves_of(const FieldState& state) {
  std::vector<DecodedLeaf> leaves;
  for (std::uint32_t i = 0; i < state.surfaces.size(); ++i) {
    const Block& block = state.surfaces[i].block;
    if (!leaves.empty() && same_block(leaves.back().block, block)) {
      ++leaves.back().layers;
    } else {
      leaves.push_back({block, i, 1, false});
    }
  }
  return leaves;
}

std::vector<std::int32_t> leaf_cells(const FieldState& state,
                                     const std::vector<DecodedLeaf>& leaves) {
  std::vector<std::int32_t> of_surface;
  of_surface.reserve(state.surfaces.size());
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    of_surface.insert(of_surface.end(), leaves[i].layers, static_cast<std::int32_t>(i));
  }
  std::vector<std::int32_t> of_cell(state.surface.size(), -1);
  for (std::size_t cell = 0; cell < of_cell.size(); ++cell) {
    const std::int32_t surface = state.surface[cell];
    if (surface != kNoSurface) of_cell[cell] = of_surface[static_cast<std::size_t>(surface)];
  }
  return of_cell;
}

std::vector<std::byte> encode_leaf_flags(const FieldState& state,
                                         const std::vector<DecodedLeaf>& leaves,
                                         const std::vector<std::int32_t>& leaf_of_cell) {
  RangeEncoder encoder;
  std::vector<DecodedLeaf> copy = leaves;
  code_flags(encoder, state, copy, leaf_of_cell);
  return std::move(encoder).finish();
}

bool decode_leaf_flags(ByteSpan bytes, const FieldState& state, std::vector<DecodedLeaf>& leaves,
                       const std::vector<std::int32_t>& leaf_of_cell) {
  RangeDecoder decoder(bytes);
  code_flags(decoder, state, leaves, leaf_of_cell);
  return !decoder.exhausted();
}

}  // namespace curlidar::compact
