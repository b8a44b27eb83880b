// SPDX-License-Identifier: BSD-3-Clause
// Files of many independent parts with an index at their end: maps and sequences. Written down in
// docs/format/curl-format-1-indexed.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/result.hpp"
#include "io/atomic_file.hpp"
#include "io/random_access.hpp"

namespace curlidar {

/// What the parts of an indexed file are. Files of other kinds are refused.
enum class IndexedKind : std::uint8_t {
  surface_map = 0,  ///< parts are tiles
  scan_map = 1,     ///< parts are scans with poses
  sequence = 2,     ///< parts are groups of scans
};
const char* to_string(IndexedKind kind);  ///< "surface map", "map of scans", "sequence"

/// Writes part by part; holds the index alone.
class IndexedWriter {
 public:
  /// `header` is the kind's own. Nothing is seen under `path` before finish(); without it nothing
  /// is left behind.
  static Result<IndexedWriter> create(const std::string& path, IndexedKind kind, ByteSpan header);
  /// One more part, and what the index says of it.
  Status add(ByteSpan part, ByteSpan summary);
  std::size_t parts() const { return parts_; }
  /// Writes the index; the file appears. Gives its size.
  Result<std::uint64_t> finish();

 private:
  explicit IndexedWriter(AtomicFile file) : file_(std::move(file)) {}

  AtomicFile file_;
  ByteWriter index_;
  std::size_t parts_ = 0;
};

struct IndexedLimits {
  std::uint64_t max_parts = 1u << 22;
  std::uint64_t max_part_bytes = 1u << 28;
};

struct IndexedOptions {
  IndexedLimits limits{};
  /// Takes a file without its end, or with a damaged index, by walking from part to part;
  /// IndexedFile::missing says what is not there, and parts have no summaries.
  bool allow_truncated = false;
};

/// Where a part lies.
struct IndexedEntry {
  std::uint64_t offset = 0;  ///< of its payload in the file
  std::uint64_t size = 0;    ///< of its payload
  std::vector<std::byte> summary;
};

/// An indexed file, opened: header and index are read, parts when asked for. Many threads may read
/// at once.
class IndexedFile {
 public:
  /// Errors as read_container; what is asked of the caller's limits gives limit_exceeded. Memory is
  /// a small multiple of what header and index take in the file.
  static Result<IndexedFile> open(std::shared_ptr<const RandomAccess> source,
                                  const IndexedOptions& options = {});

  IndexedKind kind() const { return kind_; }
  const std::vector<std::byte>& header() const { return header_; }
  const std::vector<IndexedEntry>& entries() const { return entries_; }
  /// Of the whole file, and of index, footer and end in it.
  std::uint64_t file_bytes() const { return source_->size(); }
  std::uint64_t index_bytes() const { return index_bytes_; }
  /// Where the chunk after the last part starts.
  std::uint64_t parts_end() const;
  const std::string& name() const { return source_->name(); }
  /// What should be there and is not, in a sentence: only if the caller allowed it.
  const std::optional<std::string>& missing() const { return missing_; }

  /// The payload of a part, its checksum held. Corrupt if this part is damaged: others may not be.
  Result<std::vector<std::byte>> read(std::size_t part) const;

 private:
  Status read_header(const IndexedLimits& limits);
  Status read_index(const IndexedLimits& limits);
  Status walk(const IndexedLimits& limits);

  std::shared_ptr<const RandomAccess> source_;
  IndexedKind kind_ = IndexedKind::surface_map;
  std::vector<std::byte> header_;
  std::vector<IndexedEntry> entries_;
  std::uint64_t parts_begin_ = 0;  ///< where the first part's chunk starts
  std::uint64_t index_bytes_ = 0;
  std::optional<std::string> missing_;
};

/// The kind, if the bytes of a file start as those of an indexed one do. Takes any first bytes;
/// a damaged header is told by opening the file.
std::optional<IndexedKind> indexed_kind(ByteSpan bytes);

}  // namespace curlidar
