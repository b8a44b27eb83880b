// SPDX-License-Identifier: BSD-3-Clause
#include "format/indexed_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/crc32c.hpp"
#include "base/try.hpp"
#include "format/container.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kChecksumSize = 4;
constexpr std::size_t kMaxFrameHead = 11;  ///< type and the longest varint
constexpr std::uint64_t kMaxHeaderBytes = 1u << 24;
constexpr std::size_t kFooterPayload = 16;
constexpr std::size_t kFooterChunk = 2 + kFooterPayload + kChecksumSize;
constexpr std::size_t kEndChunk = 2 + kChecksumSize;
constexpr std::size_t kTail = kFooterChunk + kEndChunk;

std::vector<std::byte> framed(ChunkType type, ByteSpan payload) {
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>(type));
  writer.write_varint(payload.size());
  writer.write_bytes(payload);
  writer.write(crc32c(writer.bytes()));
  return std::move(writer).bytes();
}

std::size_t varint_size(std::uint64_t value) {
  std::size_t size = 1;
  for (; value >= 0x80; value >>= 7) ++size;
  return size;
}

/// Bytes of a whole chunk.
std::uint64_t framed_size(std::uint64_t payload) {
  return 1 + varint_size(payload) + payload + kChecksumSize;
}

/// The frame of a chunk without its payload.
struct Frame {
  ChunkType type = ChunkType::end;
  std::uint64_t start = 0, payload = 0, size = 0;
  std::uint64_t end() const { return payload + size + kChecksumSize; }
};

Error damaged(const RandomAccess& source, std::uint64_t offset, std::string_view what) {
  return {ErrorCode::corrupt, fmt::format("{}: byte {}: {}", source.name(), offset, what)};
}

/// The frame at `start`; corrupt unless the whole chunk lies in front of `end`.
Result<Frame> read_frame(const RandomAccess& source, std::uint64_t start, std::uint64_t end) {
  const std::uint64_t left = start < end ? end - start : 0;
  CURLIDAR_TRY_ASSIGN(bytes, source.read(start, std::min<std::uint64_t>(left, kMaxFrameHead)));
  ByteReader reader(bytes);
  Frame frame;
  frame.start = start;
  frame.type = static_cast<ChunkType>(reader.read<std::uint8_t>());
  frame.size = reader.read_varint();
  frame.payload = start + reader.offset();
  const std::uint64_t room = left - reader.offset();
  if (!reader.ok() || room < kChecksumSize || frame.size > room - kChecksumSize) {
    return damaged(source, start, "a chunk reaches beyond the end; the file is cut off or damaged");
  }
  return frame;
}

/// The payload of a chunk of a type, its checksum held.
Result<std::vector<std::byte>> read_payload(const RandomAccess& source, const Frame& frame,
                                            ChunkType type) {
  if (frame.type != type) {
    return damaged(source, frame.start,
                   fmt::format("a {} chunk where a {} chunk should be", to_string(frame.type),
                               to_string(type)));
  }
  CURLIDAR_TRY_ASSIGN(bytes, source.read(frame.start, frame.end() - frame.start));
  const ByteSpan checked = ByteSpan(bytes).first(bytes.size() - kChecksumSize);
  if (load_little_endian<std::uint32_t>(bytes.data() + checked.size()) != crc32c(checked)) {
    return damaged(source, frame.start,
                   fmt::format("the {} chunk is damaged (checksum mismatch)", to_string(type)));
  }
  bytes.resize(checked.size());
  bytes.erase(bytes.begin(),
              bytes.begin() + static_cast<std::ptrdiff_t>(frame.payload - frame.start));
  return bytes;
}

Error over_limit(const RandomAccess& source, std::string_view what, std::uint64_t count,
                 std::uint64_t max) {
  return {ErrorCode::limit_exceeded,
          fmt::format("{}: {} {}, the limit is {}", source.name(), count, what, max)};
}

}  // namespace

const char* to_string(IndexedKind kind) {
  switch (kind) {
    case IndexedKind::surface_map:
      return "surface map";
    case IndexedKind::scan_map:
      return "map of scans";
    case IndexedKind::sequence:
      return "sequence";
  }
  return "unknown kind";
}

Result<IndexedWriter> IndexedWriter::create(const std::string& path, IndexedKind kind,
                                            ByteSpan header) {
  if (header.size() >= kMaxHeaderBytes) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("a header of {} bytes; keep metadata below {} bytes", header.size(),
                             kMaxHeaderBytes)};
  }
  CURLIDAR_TRY_ASSIGN(file, AtomicFile::create(path));
  IndexedWriter writer(std::move(file));
  CURLIDAR_TRY(writer.file_.write(container_header()));
  ByteWriter payload;
  payload.write(static_cast<std::uint8_t>(kind));
  payload.write_bytes(header);
  CURLIDAR_TRY(writer.file_.write(framed(ChunkType::indexed_header, payload.bytes())));
  return writer;
}

Status IndexedWriter::add(ByteSpan part, ByteSpan summary) {
  CURLIDAR_TRY(file_.write(framed(ChunkType::indexed_part, part)));
  index_.write_varint(part.size());
  index_.write_varint(summary.size());
  index_.write_bytes(summary);
  ++parts_;
  return {};
}

Result<std::uint64_t> IndexedWriter::finish() {
  ByteWriter index;
  index.write_varint(parts_);
  index.write_bytes(index_.bytes());
  const std::vector<std::byte> chunk = framed(ChunkType::indexed_index, index.bytes());
  ByteWriter footer;
  footer.write(file_.size());
  footer.write(std::uint64_t{chunk.size()});
  CURLIDAR_TRY(file_.write(chunk));
  CURLIDAR_TRY(file_.write(framed(ChunkType::indexed_footer, footer.bytes())));
  CURLIDAR_TRY(file_.write(framed(ChunkType::end, {})));
  const std::uint64_t size = file_.size();
  CURLIDAR_TRY(file_.commit());
  return size;
}

Status IndexedFile::read_header(const IndexedLimits&) {
  const std::uint64_t size = source_->size();
  CURLIDAR_TRY_ASSIGN(start, source_->read(0, std::min<std::uint64_t>(size, kHeaderSize)));
  if (const Status known = check_container_header(start); !known) {
    return Error{known.error().code, source_->name() + ": " + known.error().message};
  }
  CURLIDAR_TRY_ASSIGN(frame, read_frame(*source_, kHeaderSize, size));
  if (frame.size > kMaxHeaderBytes) {
    return damaged(*source_, kHeaderSize, fmt::format("a header of {} bytes", frame.size));
  }
  CURLIDAR_TRY_ASSIGN(payload, read_payload(*source_, frame, ChunkType::indexed_header));
  if (payload.empty()) return damaged(*source_, frame.payload, "the header names no kind");
  const auto kind = static_cast<std::uint8_t>(payload.front());
  if (kind > static_cast<std::uint8_t>(IndexedKind::sequence)) {
    return Error{ErrorCode::unsupported,
                 fmt::format("{}: byte {}: parts of unknown kind {}; the file needs a newer "
                             "version of curlidar",
                             source_->name(), frame.payload, kind)};
  }
  kind_ = static_cast<IndexedKind>(kind);
  header_.assign(payload.begin() + 1, payload.end());
  parts_begin_ = frame.end();
  return {};
}

Status IndexedFile::read_index(const IndexedLimits& limits) {
  const std::uint64_t size = source_->size();
  if (size < parts_begin_ + kTail) {
    return damaged(*source_, size, "the file is cut off: it has no footer");
  }
  const std::uint64_t footer_start = size - kTail;
  CURLIDAR_TRY_ASSIGN(end, read_frame(*source_, size - kEndChunk, size));
  CURLIDAR_TRY_ASSIGN(nothing, read_payload(*source_, end, ChunkType::end));
  CURLIDAR_TRY_ASSIGN(footer, read_frame(*source_, footer_start, size - kEndChunk));
  CURLIDAR_TRY_ASSIGN(place, read_payload(*source_, footer, ChunkType::indexed_footer));
  if (!nothing.empty() || place.size() != kFooterPayload) {
    return damaged(*source_, footer_start, "the footer has another size");
  }
  const auto index_start = load_little_endian<std::uint64_t>(place.data());
  const auto index_size = load_little_endian<std::uint64_t>(place.data() + 8);
  if (index_start < parts_begin_ || index_start > footer_start ||
      index_size != footer_start - index_start) {
    return damaged(*source_, footer_start, "the footer points to a place without an index");
  }
  CURLIDAR_TRY_ASSIGN(frame, read_frame(*source_, index_start, footer_start));
  if (frame.end() != footer_start) {
    return damaged(*source_, index_start, "the index has another size than the footer says");
  }
  CURLIDAR_TRY_ASSIGN(payload, read_payload(*source_, frame, ChunkType::indexed_index));
  index_bytes_ = size - index_start;

  ByteReader reader(payload);
  const std::uint64_t count = reader.read_varint();
  if (!reader.ok() || count > reader.remaining() / 2) {  // an entry is two bytes at least
    return damaged(*source_, frame.payload,
                   fmt::format("{} parts claimed in an index of {} bytes", count, payload.size()));
  }
  if (count > limits.max_parts) return over_limit(*source_, "parts", count, limits.max_parts);
  entries_.reserve(static_cast<std::size_t>(count));
  std::uint64_t at = parts_begin_;
  for (std::uint64_t i = 0; i < count; ++i) {
    IndexedEntry entry;
    entry.size = reader.read_varint();
    const ByteSpan summary = reader.take(reader.read_varint());
    if (!reader.ok() || entry.size > index_start ||
        framed_size(entry.size) > index_start - std::min(at, index_start)) {
      return damaged(*source_, frame.payload + reader.offset(),
                     fmt::format("entry {} of the index reaches beyond the parts", i));
    }
    entry.offset = at + 1 + varint_size(entry.size);
    entry.summary.assign(summary.begin(), summary.end());
    at += framed_size(entry.size);
    entries_.push_back(std::move(entry));
  }
  if (reader.remaining() != 0 || at != index_start) {
    return damaged(*source_, frame.payload, "the index does not tell all parts");
  }
  return {};
}

Status IndexedFile::walk(const IndexedLimits& limits) {
  entries_.clear();
  index_bytes_ = 0;
  std::uint64_t at = parts_begin_;
  while (at < source_->size()) {
    const auto frame = read_frame(*source_, at, source_->size());
    if (!frame) {
      if (frame.error().code == ErrorCode::io) return frame.error();
      break;  // the part that the file was cut off in
    }
    if (frame->type != ChunkType::indexed_part) break;
    // A longer varint than needed is no length that a writer wrote.
    if (frame->payload - frame->start != 1 + varint_size(frame->size)) break;
    if (entries_.size() == limits.max_parts) {
      return over_limit(*source_, "parts and more", entries_.size(), limits.max_parts);
    }
    entries_.push_back({frame->payload, frame->size, {}});
    at = frame->end();
  }
  return {};
}

Result<IndexedFile> IndexedFile::open(std::shared_ptr<const RandomAccess> source,
                                      const IndexedOptions& options) {
  IndexedFile file;
  file.source_ = std::move(source);
  CURLIDAR_TRY(file.read_header(options.limits));
  const Status indexed = file.read_index(options.limits);
  if (indexed) return file;
  if (!options.allow_truncated || indexed.error().code != ErrorCode::corrupt) {
    return indexed.error();
  }
  CURLIDAR_TRY(file.walk(options.limits));
  file.missing_ = fmt::format("{}; {} parts were found by walking from the front",
                              indexed.error().message, file.entries_.size());
  return file;
}

std::uint64_t IndexedFile::parts_end() const {
  return entries_.empty() ? parts_begin_
                          : entries_.back().offset + entries_.back().size + kChecksumSize;
}

Result<std::vector<std::byte>> IndexedFile::read(std::size_t part) const {
  if (part >= entries_.size()) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{}: part {} of {}", source_->name(), part, entries_.size())};
  }
  const IndexedEntry& entry = entries_[part];
  const std::uint64_t start = entry.offset - 1 - varint_size(entry.size);
  const std::uint64_t end = entry.offset + entry.size + kChecksumSize;
  const auto frame = read_frame(*source_, start, end);
  if (!frame) return frame.error();
  if (frame->payload != entry.offset || frame->size != entry.size) {
    return damaged(*source_, start,
                   fmt::format("part {} has another size than the index says", part));
  }
  return read_payload(*source_, *frame, ChunkType::indexed_part);
}

std::optional<IndexedKind> indexed_kind(ByteSpan bytes) {
  if (!is_container(bytes) || bytes.size() < kHeaderSize + 3) return std::nullopt;
  ByteReader reader(bytes.subspan(kHeaderSize));
  const auto type = reader.read<std::uint8_t>();
  reader.read_varint();
  const auto kind = reader.read<std::uint8_t>();
  if (!reader.ok() || type != static_cast<std::uint8_t>(ChunkType::indexed_header) ||
      kind > static_cast<std::uint8_t>(IndexedKind::sequence)) {
    return std::nullopt;
  }
  return static_cast<IndexedKind>(kind);
}

}  // namespace curlidar
