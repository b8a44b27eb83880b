// SPDX-License-Identifier: BSD-3-Clause
// What a sequence file says around its groups: of itself, and in the index of each group.
#pragma once

#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sequence.hpp"

namespace curlidar {

struct SequenceHead {
  std::uint32_t group = kSequenceGroup;  ///< scans of a group, the last one may have fewer
  bool still = false;
};
std::vector<std::byte> write_sequence_head(const SequenceHead& head);
/// Errors: corrupt; unsupported for what later versions may say.
Result<SequenceHead> read_sequence_head(ByteSpan bytes);

/// Scans, returns and the first time of a group; where it lies is told beside.
std::vector<std::byte> write_group_summary(const SequencePart& group);
Result<SequencePart> read_group_summary(ByteSpan summary);

}  // namespace curlidar
