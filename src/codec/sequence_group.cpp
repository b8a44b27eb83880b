// SPDX-License-Identifier: BSD-3-Clause
#include "codec/sequence_group.hpp"

#include <fmt/format.h>

#include <numeric>
#include <utility>

#include "base/try.hpp"

namespace curlidar {
namespace {

constexpr std::uint8_t kHasTimes = 1, kHasPoses = 2;
constexpr std::uint64_t kMostReturns = std::uint64_t{1} << 40;
constexpr std::uint64_t kMostScans = std::uint64_t{1} << 40;

std::uint8_t told_by(const ScanStamp& stamp) {
  return static_cast<std::uint8_t>((stamp.time_s ? kHasTimes : 0) |
                                   (stamp.T_map_sensor ? kHasPoses : 0));
}

Error corrupt(const ByteReader& reader, std::string_view what) {
  return {ErrorCode::corrupt, fmt::format("byte {} of the group: {}", reader.offset(), what)};
}

/// Numbers of returns, each told as the difference from the one before.
Status read_returns(ByteReader& reader, SequenceGroup& group) {
  std::uint64_t returns = 0;
  for (GroupScan& scan : group.scans) {
    const std::uint64_t told = reader.read_varint();
    returns += (told >> 1) ^ (0 - (told & 1));
    if (!reader.ok() || returns > kMostReturns) return corrupt(reader, "no number of returns");
    scan.returns = returns;
  }
  return {};
}

/// Sizes of all frames but the last, which goes on to the end.
Status read_sizes(ByteReader& reader, SequenceGroup& group) {
  for (std::size_t i = 0; i + 1 < group.scans.size(); ++i) {
    group.scans[i].bytes = reader.read_varint();
    if (!reader.ok()) return corrupt(reader, "the sizes of the frames end early");
  }
  return {};
}

Status place_frames(ByteSpan part, bool cut, ByteReader& reader, SequenceGroup& group) {
  const std::size_t count = group.scans.size();
  for (std::size_t i = 0; i < count; ++i) {
    GroupScan& scan = group.scans[i];
    scan.offset = reader.offset();
    const bool last = i + 1 == count;
    // Nobody knows where the last frame of a group that is cut off would have ended.
    const bool there = last ? !cut && reader.remaining() > 0 : scan.bytes <= reader.remaining();
    if (!there) {
      if (!cut) return corrupt(reader, fmt::format("the frame of its scan {} is not there", i));
      group.lost = count - i;
      group.scans.resize(i);
      return {};
    }
    if (last) scan.bytes = reader.remaining();
    reader.take(scan.bytes);
    CURLIDAR_TRY_ASSIGN(kind, frame_kind(part.subspan(scan.offset, scan.bytes)));
    scan.kind = kind;
    if ((i == 0) != (kind == FrameKind::first)) {
      return corrupt(reader, "a group has one first frame, and starts with it");
    }
  }
  return {};
}

}  // namespace

Status GroupWriter::accepts(const ScanStamp& stamp) const {
  CURLIDAR_TRY(rounded(stamp));
  if (stamps_.empty() || told_by(stamp) == told_by(stamps_.front())) return {};
  return Error{ErrorCode::invalid_argument,
               "either all scans of a group have a time, or none; likewise a pose"};
}

Status GroupWriter::add(ByteSpan frame, std::uint64_t returns, const ScanStamp& stamp) {
  CURLIDAR_TRY(accepts(stamp));
  CURLIDAR_TRY_ASSIGN(kept, rounded(stamp));
  frames_.emplace_back(frame.begin(), frame.end());
  returns_.push_back(returns);
  stamps_.push_back(kept);
  return {};
}

std::uint64_t GroupWriter::returns() const {
  return std::accumulate(returns_.begin(), returns_.end(), std::uint64_t{0});
}

std::vector<std::byte> GroupWriter::finish(std::uint64_t first_scan) {
  ByteWriter writer;
  writer.write(stamps_.empty() ? std::uint8_t{0} : told_by(stamps_.front()));
  writer.write_varint(first_scan);
  writer.write_varint(frames_.size());
  std::uint64_t before = 0;
  for (const std::uint64_t returns : returns_) {
    const std::uint64_t difference = returns - std::exchange(before, returns);
    writer.write_varint((difference << 1) ^ (0 - (difference >> 63)));
  }
  for (std::size_t i = 0; i + 1 < frames_.size(); ++i) writer.write_varint(frames_[i].size());
  write_stamps(stamps_, writer);
  for (const std::vector<std::byte>& frame : frames_) writer.write_bytes(frame);
  frames_.clear();
  returns_.clear();
  stamps_.clear();
  return std::move(writer).bytes();
}

Result<SequenceGroup> read_group(ByteSpan part, bool cut) {
  ByteReader reader(part);
  SequenceGroup group;
  const auto told = reader.read<std::uint8_t>();
  group.first_scan = reader.read_varint();
  const std::uint64_t count = reader.read_varint();
  if (!reader.ok() || told > (kHasTimes | kHasPoses)) return corrupt(reader, "no head of a group");
  if (count == 0 || count > reader.remaining() || group.first_scan > kMostScans) {
    return corrupt(reader, fmt::format("no group has {} scans after {}", count, group.first_scan));
  }
  group.scans.resize(static_cast<std::size_t>(count));
  CURLIDAR_TRY(read_returns(reader, group));
  CURLIDAR_TRY(read_sizes(reader, group));
  CURLIDAR_TRY_ASSIGN(stamps, read_stamps(reader, group.scans.size(), (told & kHasTimes) != 0,
                                          (told & kHasPoses) != 0));
  for (std::size_t i = 0; i < stamps.size(); ++i) group.scans[i].stamp = stamps[i];
  CURLIDAR_TRY(place_frames(part, cut, reader, group));
  return group;
}

}  // namespace curlidar
