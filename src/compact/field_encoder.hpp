// SPDX-License-Identifier: BSD-3-Clause
// Encodes and decodes the field of one segment.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "compact/field_search.hpp"

namespace curlidar::compact {

struct EncodedField {
  std::vector<std::byte> bytes;
  std::vector<Node> roots;
  std::array<std::uint64_t, kFieldParts> part_cost{};  ///< 1/256 bit
};

/// Searches, root by root, and writes what was found. `state` is filled as a decoder will have it;
/// `truth`: range of every occupied cell, Q16. The same bytes from every compiler.
EncodedField encode_field(FieldState& state, const std::vector<std::int32_t>& truth,
                          const SearchSettings& settings);

/// The roots of a field for those who want to look at them, in order.
struct DecodedField {
  std::vector<Node> roots;         ///< if they are to be kept
  std::size_t complete_roots = 0;  ///< known before the bytes ran out; those after it are not
};
/// Reads a field into `state`, from any bytes. `whole`: the bytes are all that was written, else
/// their end is cut off. `learnt` takes what the models of a predicted scan know then. Nodes take
/// some 300 bytes a leaf.
DecodedField decode_field(FieldState& state, ByteSpan bytes, bool whole = true,
                          bool keep_nodes = true, LearntModels* learnt = nullptr);

}  // namespace curlidar::compact
