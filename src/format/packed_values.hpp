// SPDX-License-Identifier: BSD-3-Clause
// Typed values as bytes: differences and byte planes where they help, then zstd.
#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "curlidar/cloud.hpp"
#include "format/payload.hpp"

namespace curlidar {

/// Appends values, bit for bit, in whichever form packs best. `components`: how many follow each
/// other before one resembles another again.
void write_packed_values(ByteWriter& writer, const Column& values, std::uint32_t components);

/// Reads `count` values; check `count` against the caller's limits first. Errors: corrupt.
Result<Column> read_packed_values(PayloadReader& reader, ScalarType type, std::uint64_t components,
                                  std::uint64_t count);

}  // namespace curlidar
