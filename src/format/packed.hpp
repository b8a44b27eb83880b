// SPDX-License-Identifier: BSD-3-Clause
// Blocks of bytes inside payloads: compressed by zstd where that helps, bounded when read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/result.hpp"
#include "format/payload.hpp"

namespace curlidar {

inline constexpr int kPackLevel = 19;

/// A packed block: varint 2 * size + compressed, then (if compressed) the varint size of one zstd
/// frame, then the frame or the bytes as they are, whichever is smaller.
std::vector<std::byte> pack(ByteSpan raw, int level = kPackLevel);

/// Reads a packed block of at most `max_size` unpacked bytes; limit_exceeded if it claims more,
/// corrupt if it does not unpack to exactly what it claims. Allocates no more than it claims, and
/// only when the compressed bytes present could hold that much. `what` names it in messages.
Result<std::vector<std::byte>> unpack(PayloadReader& reader, std::string_view what,
                                      std::uint64_t max_size);
/// The same, for a block whose size is known; corrupt if it is another one.
Result<std::vector<std::byte>> unpack_exactly(PayloadReader& reader, std::string_view what,
                                              std::uint64_t size);

/// A packed block of one bit a cell (0, or not 0): cell i is bit i % 8 of byte i / 8, lowest bit
/// first, in raster order without gaps between rows.
std::vector<std::byte> pack_bits(std::span<const std::uint8_t> cells);
/// Reads `cells` cells (0 or 1). Check `cells` against the caller's limits first.
Result<std::vector<std::uint8_t>> unpack_bits(PayloadReader& reader, std::string_view what,
                                              std::uint64_t cells);

/// Byte k of every value, for k = 0, 1, ...: brings bytes that resemble each other together.
/// bytes.size() must be a multiple of value_size.
std::vector<std::byte> split_planes(ByteSpan bytes, std::size_t value_size);
/// Undoes split_planes.
std::vector<std::byte> join_planes(ByteSpan planes, std::size_t value_size);

}  // namespace curlidar
