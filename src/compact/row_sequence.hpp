// SPDX-License-Identifier: BSD-3-Clause
// Codes one number for each row: elevations, heights, range offsets.
#pragma once

#include <cstdint>
#include <vector>

#include "entropy/range_coder.hpp"

namespace curlidar::compact {

/// What is expected of a sequence: a value near those before it, or a difference near those before.
enum class SequenceKind { steady, steady_differences };

/// Writes values that are multiples of 2^shift.
void write_sequence(RangeEncoder& encoder, const std::vector<std::int32_t>& values,
                    std::uint32_t shift, SequenceKind kind);

/// Reads `count` values and their shift. False if a value lies outside [-limit, limit] or the bytes
/// end before.
bool read_sequence(RangeDecoder& decoder, std::uint32_t count, std::int32_t limit,
                   std::vector<std::int32_t>& values, std::uint32_t& shift, SequenceKind kind);

}  // namespace curlidar::compact
