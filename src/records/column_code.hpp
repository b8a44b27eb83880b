// SPDX-License-Identifier: BSD-3-Clause
// One whole number for each record, coded as levels that vary in space or as a sequence that
// follows rules, whichever is shorter.
#pragma once

#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "format/payload.hpp"
#include "records/sequence_coder.hpp"

namespace curlidar {

std::vector<std::byte> encode_column(const std::vector<std::int64_t>& numbers,
                                     const SequencePlaces& places);

/// `records` numbers, as many as the places have. Errors: corrupt.
Result<std::vector<std::int64_t>> decode_column(PayloadReader& reader, std::size_t records,
                                                const SequencePlaces& places);

}  // namespace curlidar
