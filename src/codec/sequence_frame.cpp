// SPDX-License-Identifier: BSD-3-Clause
#include "codec/sequence_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <utility>

#include "base/try.hpp"
#include "format/container.hpp"

namespace curlidar {
namespace {

/// Set in a chunk's type: its payload is the last one of that type. No public type has this bit.
constexpr std::uint8_t kAsBefore = 0x40;
/// A size is told plus one; zero tells a payload that ends with the frame.
constexpr std::uint64_t kToTheEnd = 0;

bool is_remembered(ChunkType type) {
  return !may_repeat(type);
}

bool same(const std::optional<std::vector<std::byte>>& kept, ByteSpan payload) {
  return kept && std::equal(kept->begin(), kept->end(), payload.begin(), payload.end());
}

Error corrupt(const ByteReader& reader, std::string_view what) {
  return {ErrorCode::corrupt, fmt::format("frame, byte {}: {}", reader.offset(), what)};
}

/// The payload of the next chunk, whose type has been read.
Result<ByteSpan> next_payload(ByteReader& reader, std::uint8_t named, const FrameMemory& memory) {
  const auto type = static_cast<std::uint8_t>(named & ~kAsBefore);
  if ((named & kAsBefore) != 0) {
    if (is_remembered(static_cast<ChunkType>(type)) && memory.of(type)) {
      return ByteSpan(*memory.of(type));
    }
    return corrupt(reader, fmt::format("no frame before has a {} chunk to take over",
                                       to_string(static_cast<ChunkType>(type))));
  }
  const std::uint64_t told = reader.read_varint();
  const ByteSpan payload =
      reader.take(told == kToTheEnd ? std::uint64_t{reader.remaining()} : told - 1);
  if (reader.ok()) return payload;
  return corrupt(reader, fmt::format("the {} chunk is longer than the frame",
                                     to_string(static_cast<ChunkType>(type))));
}

}  // namespace

const char* to_string(FrameKind kind) {
  switch (kind) {
    case FrameKind::first:
      return "first";
    case FrameKind::alone:
      return "alone";
    case FrameKind::predicted:
      return "predicted";
  }
  return "unknown";
}

Result<FrameKind> frame_kind(std::span<const std::byte> frame) {
  if (frame.empty()) return Error{ErrorCode::corrupt, "frame, byte 0: the frame is empty"};
  const auto told = static_cast<std::uint8_t>(frame.front());
  if (told <= static_cast<std::uint8_t>(FrameKind::predicted)) return static_cast<FrameKind>(told);
  return Error{ErrorCode::corrupt, fmt::format("frame, byte 0: no kind of frame is {}", told)};
}

Result<std::vector<std::byte>> pack_frame(ByteSpan file, FrameKind kind, FrameMemory& memory) {
  CURLIDAR_TRY_ASSIGN(chunks, read_container(file));
  for (const Chunk& chunk : chunks) {
    if ((static_cast<std::uint8_t>(chunk.type) & kAsBefore) == 0) continue;
    return Error{ErrorCode::unsupported,
                 fmt::format("a sequence holds no {} chunk", to_string(chunk.type))};
  }
  if (kind == FrameKind::first) memory.clear();
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>(kind));
  for (const Chunk& chunk : chunks) {
    const auto type = static_cast<std::uint8_t>(chunk.type);
    if (is_remembered(chunk.type) && same(memory.of(type), chunk.payload)) {
      writer.write(static_cast<std::uint8_t>(type | kAsBefore));
      continue;
    }
    writer.write(type);
    const bool last = &chunk == &chunks.back();
    writer.write_varint(last ? kToTheEnd : chunk.payload.size() + 1);
    writer.write_bytes(chunk.payload);
    if (is_remembered(chunk.type)) memory.keep(type, chunk.payload);
  }
  return std::move(writer).bytes();
}

Result<std::vector<std::byte>> unpack_frame(ByteSpan frame, std::uint64_t max_bytes,
                                            FrameMemory& memory) {
  CURLIDAR_TRY_ASSIGN(kind, frame_kind(frame));
  if (kind == FrameKind::first) memory.clear();
  ByteReader reader(frame);
  reader.take(1);
  ContainerWriter writer;
  std::bitset<256> seen;
  std::uint64_t bytes = 0;
  while (reader.remaining() > 0) {
    const auto named = reader.read<std::uint8_t>();
    const auto type = static_cast<std::uint8_t>(named & ~kAsBefore);
    const auto chunk_type = static_cast<ChunkType>(type);
    if (chunk_type == ChunkType::end) return corrupt(reader, "frames have no end chunk");
    if (is_remembered(chunk_type) && seen[type]) {
      return corrupt(reader, fmt::format("a second {} chunk", to_string(chunk_type)));
    }
    seen[type] = true;
    CURLIDAR_TRY_ASSIGN(payload, next_payload(reader, named, memory));
    bytes += payload.size();
    if (bytes > max_bytes) {
      return Error{ErrorCode::limit_exceeded,
                   fmt::format("a frame's chunks have more than the {} bytes allowed", max_bytes)};
    }
    writer.add(chunk_type, payload);
    if ((named & kAsBefore) == 0 && is_remembered(chunk_type)) memory.keep(type, payload);
  }
  return std::move(writer).finish();
}

}  // namespace curlidar
