// SPDX-License-Identifier: BSD-3-Clause
#include "codec/sequence_parts.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/try.hpp"
#include "codec/sequence_stamps.hpp"

namespace curlidar {
namespace {

constexpr std::uint8_t kStill = 1;
constexpr std::uint64_t kMostReturns = std::uint64_t{1} << 48;

}  // namespace

std::vector<std::byte> write_sequence_head(const SequenceHead& head) {
  ByteWriter writer;
  writer.write(head.still ? kStill : std::uint8_t{0});
  writer.write_varint(head.group);
  return std::move(writer).bytes();
}

Result<SequenceHead> read_sequence_head(ByteSpan bytes) {
  ByteReader reader(bytes);
  const auto flags = reader.read<std::uint8_t>();
  const std::uint64_t group = reader.read_varint();
  if (reader.ok() && flags > kStill) {
    return Error{ErrorCode::unsupported,
                 "the sequence has a feature of a later version; use the curlidar release that "
                 "wrote the file"};
  }
  if (!reader.ok() || reader.remaining() > 0 || group == 0 || group > kMaxSequenceGroup) {
    return Error{ErrorCode::corrupt, "the head of the sequence makes no sense"};
  }
  return SequenceHead{static_cast<std::uint32_t>(group), flags == kStill};
}

std::vector<std::byte> write_group_summary(const SequencePart& group) {
  ByteWriter writer;
  writer.write_varint(group.scans);
  writer.write_varint(group.returns);
  if (group.time_s) {
    const auto time = static_cast<std::uint64_t>(fixed_time(*group.time_s).value());
    writer.write_varint((time << 1) ^ (0 - (time >> 63)));
  }
  return std::move(writer).bytes();
}

Result<SequencePart> read_group_summary(ByteSpan summary) {
  ByteReader reader(summary);
  SequencePart group;
  group.scans = reader.read_varint();
  group.returns = reader.read_varint();
  if (reader.remaining() > 0) {
    const std::uint64_t told = reader.read_varint();
    group.time_s = time_of(static_cast<std::int64_t>((told >> 1) ^ (0 - (told & 1))));
  }
  const bool good = reader.ok() && reader.remaining() == 0 && group.scans > 0 &&
                    group.scans <= kMaxSequenceGroup && group.returns <= kMostReturns;
  if (good) return group;
  return Error{ErrorCode::corrupt, "the index tells no group of a sequence"};
}

}  // namespace curlidar
