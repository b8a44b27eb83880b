// SPDX-License-Identifier: BSD-3-Clause
// A .curl file without what a sequence tells once: no header, no end, no checksums, and chunks that
// are those of the frame before are named only.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sequence.hpp"

namespace curlidar {

/// The payloads that later frames of a group may name: the last of every chunk type that does not
/// repeat.
class FrameMemory {
 public:
  void clear() { payloads_ = {}; }
  const std::optional<std::vector<std::byte>>& of(std::uint8_t type) const {
    return payloads_[type];
  }
  void keep(std::uint8_t type, ByteSpan payload) {
    payloads_[type].emplace(payload.begin(), payload.end());
  }

 private:
  std::array<std::optional<std::vector<std::byte>>, 256> payloads_;
};

/// Packs a whole file. The first frame of a group forgets what was before. Errors: those of
/// read_container; unsupported for chunks of private types.
Result<std::vector<std::byte>> pack_frame(ByteSpan file, FrameKind kind, FrameMemory& memory);

/// The file that was packed, as if it had been written alone. Errors: corrupt; limit_exceeded for
/// more than `max_bytes` of payload. Allocates no more than frame and memory hold.
Result<std::vector<std::byte>> unpack_frame(ByteSpan frame, std::uint64_t max_bytes,
                                            FrameMemory& memory);

}  // namespace curlidar
