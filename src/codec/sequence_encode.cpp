// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/try.hpp"
#include "codec/predicted.hpp"
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

/// A predicted scan that costs nearly what one without prediction did is tried without it, too.
constexpr double kSeldomPays = 0.95;

}  // namespace

struct SequenceEncoder::State {
  SequenceSettings settings;
  FrameMemory memory;
  std::uint32_t in_group = 0;                            ///< frames of the group so far
  std::shared_ptr<const PredictionReference> reference;  ///< the scan before, as decoded
  std::optional<RigidMotion> T_map_reference;
  double bits_alone = 0;  ///< a return, of the last scan that was not predicted

  PredictionGuess guess(const ScanStamp& stamp) const {
    PredictionGuess out;
    out.still = settings.still;
    if (T_map_reference && stamp.T_map_sensor) {
      out.motion = T_map_reference->inverse() * *stamp.T_map_sensor;
    }
    return out;
  }
  Result<Encoded> encode_alone(const Cloud& cloud, const ProgressCallback& progress);
  Result<Encoded> encode_smaller(const Cloud& cloud, const ScanStamp& stamp,
                                 const ProgressCallback& progress, bool& predicted);
  Status refer_to(const std::vector<std::byte>& file, bool predicted, const ScanStamp& stamp);
};

Result<Encoded> SequenceEncoder::State::encode_alone(const Cloud& cloud,
                                                     const ProgressCallback& progress) {
  const bool empty = count_returns(cloud) == 0;
  return encode(cloud, empty ? settings_without_returns(settings.encode) : settings.encode,
                progress);
}

/// With or without prediction.
Result<Encoded> SequenceEncoder::State::encode_smaller(const Cloud& cloud, const ScanStamp& stamp,
                                                       const ProgressCallback& progress,
                                                       bool& predicted) {
  predicted = false;
  const bool possible = in_group > 0 && reference != nullptr && count_returns(cloud) > 0 &&
                        settings.encode.profile == Profile::compact;
  if (!possible) return encode_alone(cloud, progress);
  auto coded = encode_predicted(cloud, settings.encode, reference, guess(stamp), progress);
  if (!coded) return encode_alone(cloud, progress);  // says what is wrong, if anything is
  predicted = true;
  if (coded->report.bits_per_point < kSeldomPays * bits_alone) return coded;
  auto alone = encode_alone(cloud, progress);
  if (!alone || alone->bytes.size() >= coded->bytes.size()) return coded;
  predicted = false;
  return alone;
}

/// The next scan may be predicted from this one.
Status SequenceEncoder::State::refer_to(const std::vector<std::byte>& file, bool predicted,
                                        const ScanStamp& stamp) {
  const auto before = std::exchange(reference, nullptr);
  T_map_reference = stamp.T_map_sensor;
  if (in_group == 0) return {};  // the group ends here
  DecodeOptions options;
  options.limits = {UINT64_MAX, UINT64_MAX};
  options.threads = settings.encode.threads;
  if (predicted) options.reference = before;
  CURLIDAR_TRY_ASSIGN(scan, decode(file, options));
  if (auto made = PredictionReference::of(scan)) reference = *std::move(made);
  return {};
}

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

Result<EncodedFrame> SequenceEncoder::add(const Cloud& cloud, const ScanStamp& stamp,
                                          const ProgressCallback& progress) {
  State& state = *state_;
  bool predicted = false;
  CURLIDAR_TRY_ASSIGN(encoded, state.encode_smaller(cloud, stamp, progress, predicted));
  EncodedFrame frame;
  frame.kind = state.in_group == 0 ? FrameKind::first
               : predicted         ? FrameKind::predicted
                                   : FrameKind::alone;
  CURLIDAR_TRY_ASSIGN(bytes, pack_frame(encoded.bytes, frame.kind, state.memory));
  if (!predicted) state.bits_alone = encoded.report.bits_per_point;
  state.in_group = (state.in_group + 1) % state.settings.group;
  CURLIDAR_TRY(state.refer_to(encoded.bytes, predicted, stamp));
  frame.bytes = std::move(bytes);
  frame.report = std::move(encoded.report);
  count_frame(frame.bytes.size(), frame.report);
  return frame;
}

}  // namespace curlidar
