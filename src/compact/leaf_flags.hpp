// SPDX-License-Identifier: BSD-3-Clause
// The leaves of a coded field, and which of them have residuals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "compact/field_state.hpp"
#include "compact/scan_decoder.hpp"

namespace curlidar::compact {

/// The leaves with returns of a coded field, in the order of coding.
std::vector<DecodedLeaf> leaves_of(const FieldState& state);

/// The leaf of each cell of a segment, -1 where none.
std::vector<std::int32_t> leaf_cells(const FieldState& state,
                                     const std::vector<DecodedLeaf>& leaves);

/// Whether each leaf has residuals, one bit a leaf by what its left and upper neighbour have.
std::vector<std::byte> encode_leaf_flags(const FieldState& state,
                                         const std::vector<DecodedLeaf>& leaves,
                                         const std::vector<std::int32_t>& leaf_of_cell);
/// False if the bytes end before.
bool decode_leaf_flags(ByteSpan bytes, const FieldState& state, std::vector<DecodedLeaf>& leaves,
                       const std::vector<std::int32_t>& leaf_of_cell);

}  // namespace curlidar::compact
