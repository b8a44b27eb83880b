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

/// `state` is filled as a decoder will have it; `truth`: range of every occupied cell, Q16.
EncodedField encode_field(FieldState& state, const std::vector<std::int32_t>& truth,
                          const SearchSettings& settings, std::uint32_t passes);

/// Reads a field into `state`. Never fails: `rows_of_roots` complete before the bytes ran out are
/// counted; `whole`: the bytes are all that was
/// written; else their end is cut off. The nodes are kept for those who want to look at
/// them.
struct DecodedField {
  std::vector<Node> roots;
  std::size_t complete_roots = 0;
};
DecodedField decode_field(FieldState& state, ByteSpan bytes, bool whole = true);

}  // namespace curlidar::compact
