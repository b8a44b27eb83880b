// SPDX-License-Identifier: BSD-3-Clause
#include "format/container.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/crc32c.hpp"
#include "base/try.hpp"

namespace curlidar {
namespace {

// A byte above 127 and a carriage return: transfers that strip bit 7 or change line ends show.
constexpr std::array<std::uint8_t, 7> kMagic{0x89, 'C', 'U', 'R', 'L', 0x0d, 0x0a};
constexpr std::size_t kMagicBeforeLineEnd = 5;

ByteSpan magic() {
  return std::as_bytes(std::span(kMagic));
}

bool starts_with(ByteSpan bytes, ByteSpan prefix) {
  return bytes.size() >= prefix.size() && std::equal(prefix.begin(), prefix.end(), bytes.begin());
}

const char* name_of(ChunkType type) {
  switch (type) {
    case ChunkType::end:
      return "end";
    case ChunkType::sensor:
      return "sensor";
    case ChunkType::parameters:
      return "parameters";
    case ChunkType::point_grid:
      return "point_grid";
    case ChunkType::cliffs:
      return "cliffs";
    case ChunkType::patches:
      return "patches";
    case ChunkType::global:
      return "global";
    case ChunkType::attributes:
      return "attributes";
    case ChunkType::metadata:
      return "metadata";
  }
  return nullptr;
}

Status check_header(ByteSpan bytes) {
  if (!starts_with(bytes, magic())) {
    if (starts_with(bytes, magic().first(kMagicBeforeLineEnd))) {
      return Error{ErrorCode::corrupt,
                   "byte 5: the .curl header is damaged, as by a transfer in text mode; copy the "
                   "file again in binary mode"};
    }
    return Error{ErrorCode::corrupt,
                 "byte 0: not a .curl file (its first bytes are not \"\\x89CURL\\r\\n\")"};
  }
  if (bytes.size() < kHeaderSize) {
    return Error{ErrorCode::corrupt, "byte 7: the .curl file is cut off inside its header"};
  }
  const auto version = static_cast<unsigned>(bytes[kHeaderSize - 1]);
  if (version != kFormatVersion) {
    return Error{ErrorCode::unsupported,
                 fmt::format("byte 7: .curl format version {}, but this program reads version {} "
                             "only; use the curlidar release that wrote the file",
                             version, kFormatVersion)};
  }
  return {};
}

/// The chunk that starts at the reader's place.
Result<Chunk> read_chunk(ByteReader& reader, ByteSpan bytes) {
  const std::size_t start = reader.offset();
  if (reader.remaining() == 0) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {}: the .curl file is cut off: no end chunk", start)};
  }
  Chunk chunk;
  chunk.type = static_cast<ChunkType>(reader.read<std::uint8_t>());
  const std::uint64_t size = reader.read_varint();
  chunk.offset = reader.offset();
  const std::size_t available = reader.remaining();
  chunk.payload = reader.take(size);
  const ByteSpan checked = bytes.subspan(start, reader.offset() - start);
  const auto checksum = reader.read<std::uint32_t>();
  if (!reader.ok()) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {}: the {} chunk claims {} bytes and a checksum, but only {} "
                             "bytes are left; the file is cut off or damaged",
                             start, to_string(chunk.type), size, available)};
  }
  if (checksum != crc32c(checked)) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {}: the {} chunk is damaged (checksum mismatch)", start,
                             to_string(chunk.type))};
  }
  return chunk;
}

Status check_end(const Chunk& chunk, const ByteReader& reader) {
  if (!chunk.payload.empty()) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {}: the end chunk is not empty", chunk.offset)};
  }
  if (reader.remaining() != 0) {
    return Error{ErrorCode::corrupt, fmt::format("byte {}: {} bytes follow the end chunk",
                                                 reader.offset(), reader.remaining())};
  }
  return {};
}

}  // namespace

std::string to_string(ChunkType type) {
  const char* name = name_of(type);
  return name != nullptr ? name : fmt::format("{:#04x}", static_cast<unsigned>(type));
}

ContainerWriter::ContainerWriter() {
  writer_.write_bytes(magic());
  writer_.write(kFormatVersion);
}

void ContainerWriter::add(ChunkType type, ByteSpan payload) {
  const std::size_t start = writer_.size();
  writer_.write(static_cast<std::uint8_t>(type));
  writer_.write_varint(payload.size());
  writer_.write_bytes(payload);
  writer_.write(crc32c(ByteSpan(writer_.bytes()).subspan(start)));
}

std::vector<std::byte> ContainerWriter::finish() && {
  add(ChunkType::end, {});
  return std::move(writer_).bytes();
}

bool is_container(ByteSpan bytes) {
  return starts_with(bytes, magic());
}

Result<std::vector<Chunk>> read_container(ByteSpan bytes) {
  CURLIDAR_TRY(check_header(bytes));
  ByteReader reader(bytes);
  reader.take(kHeaderSize);
  std::array<bool, 256> seen{};
  std::vector<Chunk> chunks;
  while (true) {
    CURLIDAR_TRY_ASSIGN(chunk, read_chunk(reader, bytes));
    if (chunk.type == ChunkType::end) {
      CURLIDAR_TRY(check_end(chunk, reader));
      return chunks;
    }
    const bool known = name_of(chunk.type) != nullptr;
    if (!known && !is_ancillary(chunk.type)) {
      return Error{ErrorCode::unsupported,
                   fmt::format("byte {}: unknown critical chunk {}; the file needs a newer version "
                               "of curlidar, or the program that wrote it",
                               chunk.offset, to_string(chunk.type))};
    }
    if (known && std::exchange(seen[static_cast<std::uint8_t>(chunk.type)], true)) {
      return Error{ErrorCode::corrupt,
                   fmt::format("byte {}: a second {} chunk", chunk.offset, to_string(chunk.type))};
    }
    if (chunks.size() == kMaxChunks) {
      return Error{ErrorCode::limit_exceeded,
                   fmt::format("byte {}: more than {} chunks", chunk.offset, kMaxChunks)};
    }
    chunks.push_back(chunk);
  }
}

const Chunk* find_chunk(const std::vector<Chunk>& chunks, ChunkType type) {
  const auto found = std::find_if(chunks.begin(), chunks.end(),
                                  [&](const Chunk& chunk) { return chunk.type == type; });
  return found == chunks.end() ? nullptr : &*found;
}

Result<Chunk> require_chunk(const std::vector<Chunk>& chunks, ChunkType type) {
  if (const Chunk* chunk = find_chunk(chunks, type)) return *chunk;
  return Error{ErrorCode::corrupt, fmt::format("the .curl file has no {} chunk", to_string(type))};
}

}  // namespace curlidar
