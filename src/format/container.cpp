// SPDX-License-Identifier: BSD-3-Clause
#include "format/container.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "base/crc32c.hpp"
#include "base/try.hpp"

namespace curlidar {
namespace {

// A byte above 127 and a carriage return: transfers that strip bit 7 or change line ends show.
constexpr std::array<std::uint8_t, 7> kMagic{0x89, 'C', 'U', 'R', 'L', 0x0d, 0x0a};
constexpr std::size_t kMagicBeforeLineEnd = 5;
constexpr std::size_t kMaxVarintSize = 10;

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
    case ChunkType::compact_parameters:
      return "compact_parameters";
    case ChunkType::compact_sensor:
      return "compact_sensor";
    case ChunkType::compact_index:
      return "compact_index";
    case ChunkType::compact_mask:
      return "compact_mask";
    case ChunkType::compact_field:
      return "compact_field";
    case ChunkType::compact_residual:
      return "compact_residual";
    case ChunkType::compact_rays:
      return "compact_rays";
    case ChunkType::compact_prediction:
      return "compact_prediction";
    case ChunkType::directions:
      return "directions";
    case ChunkType::loose:
      return "loose";
    case ChunkType::corrections:
      return "corrections";
    case ChunkType::order:
      return "order";
    case ChunkType::records:
      return "records";
    case ChunkType::indexed_header:
      return "indexed_header";
    case ChunkType::indexed_part:
      return "indexed_part";
    case ChunkType::indexed_index:
      return "indexed_index";
    case ChunkType::indexed_footer:
      return "indexed_footer";
    case ChunkType::promise:
      return "promise";
    case ChunkType::metadata:
      return "metadata";
  }
  return nullptr;
}

/// A chunk as far as it is there.
struct FoundChunk {
  std::size_t start = 0;  ///< of the chunk in the file
  bool sized = false;     ///< type and size are there
  bool whole = false;     ///< the checksum is there too, and right
  TornChunk part;
};

/// The chunk that starts at the reader's place; corrupt if it is damaged.
Result<FoundChunk> read_chunk(ByteReader& reader, ByteSpan bytes) {
  FoundChunk found;
  found.start = reader.offset();
  TornChunk& part = found.part;
  part.type = static_cast<ChunkType>(reader.read<std::uint8_t>());
  const std::size_t before_size = reader.remaining();
  part.size = reader.read_varint();
  if (!reader.ok()) {
    if (before_size < kMaxVarintSize) return found;
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {}: the {} chunk has no valid size; the file is damaged",
                             found.start, to_string(part.type))};
  }
  found.sized = true;
  part.offset = reader.offset();
  part.payload = reader.take(std::min<std::uint64_t>(part.size, reader.remaining()));
  const ByteSpan checked = bytes.subspan(found.start, reader.offset() - found.start);
  const auto checksum = reader.read<std::uint32_t>();
  found.whole = reader.ok() && part.payload.size() == part.size;
  if (found.whole && checksum != crc32c(checked)) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {}: the {} chunk is damaged (checksum mismatch)", found.start,
                             to_string(part.type))};
  }
  return found;
}

/// Whether a chunk of this type may stand here; `seen` are the types before it.
Status check_type(ChunkType type, std::size_t offset, std::array<bool, 256>& seen) {
  const bool known = name_of(type) != nullptr;
  if (!known && !is_ancillary(type)) {
    return Error{ErrorCode::unsupported,
                 fmt::format("byte {}: unknown critical chunk {}; the file needs a newer version "
                             "of curlidar, or the program that wrote it",
                             offset, to_string(type))};
  }
  const bool again = std::exchange(seen[static_cast<std::uint8_t>(type)], true);
  if (known && again && !may_repeat(type)) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {}: a second {} chunk", offset, to_string(type))};
  }
  return {};
}

Status check_end(const FoundChunk& end, const ByteReader& reader) {
  if (end.part.size != 0) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {}: the end chunk is not empty", end.part.offset)};
  }
  if (end.whole && reader.remaining() != 0) {
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

std::vector<std::byte> container_header() {
  ByteWriter writer;
  writer.write_bytes(magic());
  writer.write(kFormatVersion);
  return std::move(writer).bytes();
}

Status check_container_header(ByteSpan bytes) {
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

ContainerWriter::ContainerWriter() {
  writer_.write_bytes(container_header());
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

Result<PartialContainer> read_container_prefix(ByteSpan bytes) {
  CURLIDAR_TRY(check_container_header(bytes));
  ByteReader reader(bytes);
  reader.take(kHeaderSize);
  std::array<bool, 256> seen{};
  PartialContainer file;
  while (true) {
    file.cut_chunk = reader.offset();
    if (reader.remaining() == 0) return file;
    CURLIDAR_TRY_ASSIGN(found, read_chunk(reader, bytes));
    if (!found.sized) return file;
    const TornChunk& part = found.part;
    if (part.type == ChunkType::end) {
      CURLIDAR_TRY(check_end(found, reader));
      file.complete = found.whole;
      if (!found.whole) file.torn = part;
      return file;
    }
    CURLIDAR_TRY(check_type(part.type, part.offset, seen));
    if (!found.whole) {
      file.torn = part;
      return file;
    }
    if (file.chunks.size() == kMaxChunks) {
      return Error{ErrorCode::limit_exceeded,
                   fmt::format("byte {}: more than {} chunks", part.offset, kMaxChunks)};
    }
    file.chunks.push_back({part.type, part.payload, part.offset});
  }
}

Result<std::vector<Chunk>> read_container(ByteSpan bytes) {
  CURLIDAR_TRY_ASSIGN(file, read_container_prefix(bytes));
  if (file.complete) return std::move(file.chunks);
  if (!file.torn) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {}: the .curl file is cut off: no end chunk", file.cut_chunk)};
  }
  return Error{ErrorCode::corrupt,
               fmt::format("byte {}: the {} chunk claims {} bytes and a checksum, but only {} "
                           "bytes are left; the file is cut off or damaged",
                           file.cut_chunk, to_string(file.torn->type), file.torn->size,
                           bytes.size() - file.torn->offset)};
}

const Chunk* find_chunk(const std::vector<Chunk>& chunks, ChunkType type) {
  const auto found = std::find_if(chunks.begin(), chunks.end(),
                                  [&](const Chunk& chunk) { return chunk.type == type; });
  return found == chunks.end() ? nullptr : &*found;
}

std::vector<Chunk> find_chunks(const std::vector<Chunk>& chunks, ChunkType type) {
  std::vector<Chunk> found;
  std::copy_if(chunks.begin(), chunks.end(), std::back_inserter(found),
               [&](const Chunk& chunk) { return chunk.type == type; });
  return found;
}

Result<Chunk> require_chunk(const std::vector<Chunk>& chunks, ChunkType type) {
  if (const Chunk* chunk = find_chunk(chunks, type)) return *chunk;
  return Error{ErrorCode::corrupt, fmt::format("the .curl file has no {} chunk", to_string(type))};
}

}  // namespace curlidar
