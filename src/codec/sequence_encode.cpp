// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/try.hpp"
#include "codec/sequence_frame.hpp"
#include "curlidar/sequence.hpp"

namespace curlidar {
namespace {

/// A scan without returns is kept as the slots that it has, whatever was asked for.
EncodeSettings settings_without_returns(EncodeSettings settings) {
  settings.profile = Profile::compact;
  settings.compact.coverage = Coverage::every_return;
  settings.compact.columns = 0;
  settings.compact.min_range_m = 0;
  settings.compact.max_range = {};
  settings.sensor.reset();
  return settings;
}

/// What a report says of a file, said of the frame that it became.
void count_frame(std::size_t frame_bytes, EncodeReport& report) {
  const double saved = 8 * (static_cast<double>(report.bytes) - static_cast<double>(frame_bytes));
  const auto returns = static_cast<double>(std::max<std::size_t>(report.points_in, 1));
  report.bytes = frame_bytes;
  report.bits_per_point = 8.0 * static_cast<double>(frame_bytes) / returns;
  if (!report.compact) return;
  report.compact->breakdown.header -= saved;
  report.compact->bits_per_point_coded -=
      saved / static_cast<double>(std::max<std::size_t>(report.points_coded, 1));
}

}  // namespace

struct SequenceEncoder::State {
  SequenceSettings settings;
  FrameMemory memory;
  std::uint32_t in_group = 0;  ///< frames of the group so far
};

Result<SequenceEncoder> SequenceEncoder::create(const SequenceSettings& settings) {
  if (settings.group == 0 || settings.group > kMaxSequenceGroup) {
    return Error{ErrorCode::invalid_argument, fmt::format("a group of {} scans: give 1 to {}",
                                                          settings.group, kMaxSequenceGroup)};
  }
  auto state = std::make_unique<State>();
  state->settings = settings;
  return SequenceEncoder(std::move(state));
}

SequenceEncoder::SequenceEncoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
SequenceEncoder::SequenceEncoder(SequenceEncoder&&) noexcept = default;
SequenceEncoder& SequenceEncoder::operator=(SequenceEncoder&&) noexcept = default;
SequenceEncoder::~SequenceEncoder() = default;

void SequenceEncoder::start_group() {
  state_->in_group = 0;
}

Result<EncodedFrame> SequenceEncoder::add(const Cloud& cloud, const ScanStamp&,
                                          const ProgressCallback& progress) {
  State& state = *state_;
  const bool empty = count_returns(cloud) == 0;
  CURLIDAR_TRY_ASSIGN(
      encoded,
      encode(cloud, empty ? settings_without_returns(state.settings.encode) : state.settings.encode,
             progress));
  EncodedFrame frame;
  frame.kind = state.in_group == 0 ? FrameKind::first : FrameKind::alone;
  CURLIDAR_TRY_ASSIGN(bytes, pack_frame(encoded.bytes, frame.kind, state.memory));
  frame.bytes = std::move(bytes);
  frame.report = std::move(encoded.report);
  count_frame(frame.bytes.size(), frame.report);
  state.in_group = (state.in_group + 1) % state.settings.group;
  return frame;
}

}  // namespace curlidar
