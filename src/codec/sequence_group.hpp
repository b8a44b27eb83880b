// SPDX-License-Identifier: BSD-3-Clause
// A group of a sequence as the part of a file: what is known of its scans, then their frames.
#pragma once

#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "codec/sequence_stamps.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sequence.hpp"

namespace curlidar {

struct GroupScan {
  std::uint64_t returns = 0;
  ScanStamp stamp;
  std::size_t offset = 0, bytes = 0;  ///< of its frame, in the part
  FrameKind kind = FrameKind::first;
};

struct SequenceGroup {
  std::uint64_t first_scan = 0;  ///< its number in the sequence
  std::vector<GroupScan> scans;
  std::uint64_t lost = 0;  ///< scans that were cut off
};

/// Frames of one group on their way into a part.
class GroupWriter {
 public:
  /// Invalid_argument if the stamp cannot be held or differs in what it tells from the others.
  Status accepts(const ScanStamp& stamp) const;
  /// Errors: those of accepts().
  Status add(ByteSpan frame, std::uint64_t returns, const ScanStamp& stamp);
  std::size_t scans() const { return frames_.size(); }
  std::uint64_t returns() const;
  /// The part; what it was made of is forgotten.
  std::vector<std::byte> finish(std::uint64_t first_scan);

 private:
  std::vector<std::vector<std::byte>> frames_;
  std::vector<std::uint64_t> returns_;
  std::vector<ScanStamp> stamps_;
};

/// Reads what a part tells, not what its frames hold. With `cut` the part may end early: the scans
/// whose frames are whole are told. Errors: corrupt. O(scans), allocates O(scans that are there).
Result<SequenceGroup> read_group(ByteSpan part, bool cut = false);

}  // namespace curlidar
