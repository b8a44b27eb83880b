// SPDX-License-Identifier: BSD-3-Clause
// LZF, the byte compression of binary_compressed PCD files.
//
// A stream is a row of commands. A first byte below 32 starts a run of (byte + 1) literal bytes.
// Otherwise its upper three bits are a length L and its lower five bits the high bits of a distance
// D; if L is 7, the next byte is added to L; the next byte gives the low bits of D. The command
// copies L + 2 bytes from D + 1 bytes back; source and target may overlap.
#pragma once

#include <optional>
#include <vector>

#include "base/bytes.hpp"

namespace curlidar::io {

/// A command of 3 bytes gives at most 264: no stream grows more than this many times.
inline constexpr std::uint64_t kLzfMaxExpansion = 88;

/// Compresses; any input, at most 33/32 of its size plus one. O(n).
std::vector<std::byte> lzf_compress(ByteSpan input);

/// Decompresses a stream that gives exactly `size` bytes; nothing if it does not, or if it is
/// damaged. Allocates nothing when `size` is beyond what the input can give.
std::optional<std::vector<std::byte>> lzf_decompress(ByteSpan input, std::uint64_t size);

}  // namespace curlidar::io
