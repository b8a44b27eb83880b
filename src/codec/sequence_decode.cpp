// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <utility>

#include "base/try.hpp"
#include "codec/sequence_frame.hpp"
#include "curlidar/sequence.hpp"

namespace curlidar {

struct SequenceDecoder::State {
  DecodeLimits limits;
  std::size_t threads = 1;
  FrameMemory memory;
  bool in_group = false;  ///< all frames of the group before the next one were given

  /// The file of the next frame; only a first one may follow if this or what is done with it fails.
  Result<std::vector<std::byte>> take(std::span<const std::byte> frame, FrameKind kind) {
    if (kind != FrameKind::first && !in_group) {
      return Error{ErrorCode::corrupt,
                   fmt::format("the frames before this {} one are needed, from the first of its "
                               "group on",
                               to_string(kind))};
    }
    in_group = false;
    return unpack_frame(frame, limits.max_bytes, memory);
  }
};

SequenceDecoder::SequenceDecoder(const DecodeLimits& limits, std::size_t threads)
    : state_(std::make_unique<State>()) {
  state_->limits = limits;
  state_->threads = threads;
}
SequenceDecoder::SequenceDecoder(SequenceDecoder&&) noexcept = default;
SequenceDecoder& SequenceDecoder::operator=(SequenceDecoder&&) noexcept = default;
SequenceDecoder::~SequenceDecoder() = default;

Result<DecodedScan> SequenceDecoder::add(std::span<const std::byte> frame,
                                         const DecodeOptions& options) {
  CURLIDAR_TRY_ASSIGN(kind, frame_kind(frame));
  CURLIDAR_TRY_ASSIGN(file, state_->take(frame, kind));
  DecodeOptions decoding = options;
  decoding.limits = state_->limits;
  decoding.threads = state_->threads;
  decoding.allow_truncated = false;
  CURLIDAR_TRY_ASSIGN(scan, decode(file, decoding));
  state_->in_group = true;
  return scan;
}

Status SequenceDecoder::skip(std::span<const std::byte> frame) {
  CURLIDAR_TRY_ASSIGN(kind, frame_kind(frame));
  CURLIDAR_TRY(state_->take(frame, kind));
  state_->in_group = true;
  return {};
}

Result<std::vector<std::byte>> SequenceDecoder::file_of(std::span<const std::byte> frame) {
  CURLIDAR_TRY_ASSIGN(kind, frame_kind(frame));
  CURLIDAR_TRY_ASSIGN(file, state_->take(frame, kind));
  state_->in_group = true;
  if (kind == FrameKind::predicted) {
    return Error{ErrorCode::unsupported,
                 "a scan that is predicted from the one before is no file of its own"};
  }
  return file;
}

}  // namespace curlidar
