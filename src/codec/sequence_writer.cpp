// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "base/try.hpp"
#include "codec/sequence_group.hpp"
#include "codec/sequence_parts.hpp"
#include "curlidar/sequence.hpp"
#include "format/indexed_file.hpp"

namespace curlidar {

struct SequenceWriter::State {
  SequenceEncoder encoder;
  IndexedWriter file;
  GroupWriter group;
  std::uint32_t most;       ///< scans of a group
  ScanStamp first_stamp{};  ///< of the group
  std::uint64_t scans = 0;

  Status finish_group() {
    if (group.scans() == 0) return {};
    SequencePart part;
    part.scans = group.scans();
    part.returns = group.returns();
    part.time_s = first_stamp.time_s;
    const std::vector<std::byte> bytes = group.finish(scans);
    scans += part.scans;
    return file.add(bytes, write_group_summary(part));
  }
};

Result<SequenceWriter> SequenceWriter::create(const std::string& path,
                                              const SequenceSettings& settings) {
  CURLIDAR_TRY_ASSIGN(encoder, SequenceEncoder::create(settings));
  CURLIDAR_TRY_ASSIGN(file,
                      IndexedWriter::create(path, IndexedKind::sequence,
                                            write_sequence_head({settings.group, settings.still})));
  return SequenceWriter(
      std::make_unique<State>(State{std::move(encoder), std::move(file), {}, settings.group}));
}

SequenceWriter::SequenceWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
SequenceWriter::SequenceWriter(SequenceWriter&&) noexcept = default;
SequenceWriter& SequenceWriter::operator=(SequenceWriter&&) noexcept = default;
SequenceWriter::~SequenceWriter() = default;

Result<EncodedFrame> SequenceWriter::add(const Cloud& cloud, const ScanStamp& stamp,
                                         const ProgressCallback& progress) {
  // Before the work: a scan that the encoder took is one that others are predicted from.
  CURLIDAR_TRY_ASSIGN(kept, rounded(stamp));
  if (state_->group.scans() < state_->most) CURLIDAR_TRY(state_->group.accepts(kept));
  CURLIDAR_TRY_ASSIGN(frame, state_->encoder.add(cloud, kept, progress));
  if (frame.kind == FrameKind::first) {
    CURLIDAR_TRY(state_->finish_group());
    state_->first_stamp = kept;
  }
  CURLIDAR_TRY(state_->group.add(frame.bytes, count_returns(cloud), kept));
  return frame;
}

Result<std::uint64_t> SequenceWriter::finish() {
  CURLIDAR_TRY(state_->finish_group());
  if (state_->scans == 0) {
    return Error{ErrorCode::invalid_argument, "a sequence of no scan is no file"};
  }
  return state_->file.finish();
}

}  // namespace curlidar
