// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <utility>

#include "base/try.hpp"
#include "codec/predicted.hpp"
#include "codec/sequence_frame.hpp"
#include "curlidar/sequence.hpp"

namespace curlidar {

struct SequenceDecoder::State {
  DecodeLimits limits;
  std::size_t threads = 1;
  FrameMemory memory;
  std::shared_ptr<const PredictionReference> reference;  ///< the scan before, if it was decoded
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

  /// The next frame may be predicted from this scan, or from all of it if only a part was wanted.
  Status refer_to(const DecodedScan& scan, ByteSpan file, DecodeOptions decoding) {
    if (!decoding.region && !decoding.field_only) {
      if (auto made = PredictionReference::of(scan)) reference = *std::move(made);
      return {};
    }
    decoding.region.reset();
    decoding.field_only = false;
    CURLIDAR_TRY_ASSIGN(whole, decode(file, decoding));
    if (auto made = PredictionReference::of(whole)) reference = *std::move(made);
    return {};
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
  State& state = *state_;
  CURLIDAR_TRY_ASSIGN(kind, frame_kind(frame));
  CURLIDAR_TRY_ASSIGN(file, state.take(frame, kind));
  const auto before = std::exchange(state.reference, nullptr);
  DecodeOptions decoding = options;
  decoding.limits = state.limits;
  decoding.threads = state.threads;
  decoding.allow_truncated = false;
  decoding.reference = nullptr;
  if (kind == FrameKind::predicted) {
    if (before == nullptr) {
      return Error{ErrorCode::corrupt,
                   "the frame is predicted from the scan before it, which has no image or was not "
                   "decoded"};
    }
    decoding.reference = before;
  }
  CURLIDAR_TRY_ASSIGN(scan, decode(file, decoding));
  CURLIDAR_TRY(state.refer_to(scan, file, decoding));
  state.in_group = true;
  return scan;
}

Status SequenceDecoder::skip(std::span<const std::byte> frame) {
  CURLIDAR_TRY_ASSIGN(kind, frame_kind(frame));
  CURLIDAR_TRY(state_->take(frame, kind));
  state_->reference = nullptr;
  state_->in_group = true;
  return {};
}

Result<std::vector<std::byte>> SequenceDecoder::file_of(std::span<const std::byte> frame) {
  CURLIDAR_TRY_ASSIGN(kind, frame_kind(frame));
  CURLIDAR_TRY_ASSIGN(file, state_->take(frame, kind));
  state_->reference = nullptr;
  state_->in_group = true;
  if (kind == FrameKind::predicted) {
    return Error{ErrorCode::unsupported,
                 "a scan that is predicted from the one before is no file of its own"};
  }
  return file;
}

}  // namespace curlidar
