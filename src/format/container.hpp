// SPDX-License-Identifier: BSD-3-Clause
// The .curl container: magic, version, checksummed chunks. Written down in
// docs/format/curl-format-1.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// The format version written and read by this library. Files of another version are refused, and
/// so are those of version 0, the draft before it.
inline constexpr std::uint8_t kFormatVersion = 1;
inline constexpr std::size_t kHeaderSize = 8;
/// More chunks than this are refused.
inline constexpr std::size_t kMaxChunks = 65536;

/// Bit 7 set: ancillary, a reader that does not know the type skips the chunk. Clear: critical, it
/// refuses the file. 0x70..0x7f and 0xf0..0xff are for private use.
enum class ChunkType : std::uint8_t {
  end = 0x00,
  sensor = 0x01,
  parameters = 0x02,
  point_grid = 0x03,
  cliffs = 0x04,
  patches = 0x05,
  global = 0x06,
  attributes = 0x07,
  compact_parameters = 0x10,
  compact_sensor = 0x11,
  compact_index = 0x12,
  compact_mask = 0x13,      ///< one for each segment, in the order of the segments
  compact_field = 0x14,     ///< likewise
  compact_residual = 0x15,  ///< likewise
  compact_rays = 0x16,
  compact_prediction = 0x17,
  directions = 0x20,      ///< where returns lie beside the middles of their cells
  loose = 0x21,           ///< points that are in no cell
  corrections = 0x22,     ///< what brings points within a bound, or back bit for bit
  order = 0x23,           ///< the slots of the cloud: their order, shape and kind
  records = 0x24,         ///< attributes of every slot
  indexed_header = 0x30,  ///< of files of many parts (format/indexed_file.hpp)
  indexed_part = 0x31,    ///< one for each part
  indexed_index = 0x32,
  indexed_footer = 0x33,
  metadata = 0x80,
  promise = 0x81,  ///< how exactly the points come back
};

inline bool is_ancillary(ChunkType type) {
  return (static_cast<std::uint8_t>(type) & 0x80) != 0;
}
/// Whether a file may hold more than one chunk of a known type.
inline bool may_repeat(ChunkType type) {
  return type == ChunkType::compact_mask || type == ChunkType::compact_field ||
         type == ChunkType::compact_residual || type == ChunkType::indexed_part;
}
/// "sensor", "metadata", ...; "0x71" for a type without a name.
std::string to_string(ChunkType type);

/// The first kHeaderSize bytes of every file.
std::vector<std::byte> container_header();
/// Whether `bytes` start with them. Errors: corrupt, unsupported (another version).
Status check_container_header(ByteSpan bytes);

/// Collects chunks into a file.
class ContainerWriter {
 public:
  ContainerWriter();
  /// Appends a chunk. Known types that may not repeat are added once at most; finish()
  /// adds `end`.
  void add(ChunkType type, ByteSpan payload);
  /// Closes the file and gives its bytes.
  std::vector<std::byte> finish() &&;

 private:
  ByteWriter writer_;
};

/// A chunk inside the bytes that it was read from.
struct Chunk {
  ChunkType type = ChunkType::end;
  ByteSpan payload;
  std::size_t offset = 0;  ///< of the payload in the file
};

/// Whether `bytes` start as a .curl file of any version does.
bool is_container(ByteSpan bytes);

/// The chunks of a file in file order, without the end chunk; ancillary ones of unknown type
/// included. The payloads point into `bytes`. Errors: corrupt (not such a file, cut off, damaged,
/// a known chunk twice that may not repeat), unsupported (another version, an unknown critical
/// chunk), limit_exceeded (more than kMaxChunks). O(size), allocates O(chunks).
Result<std::vector<Chunk>> read_container(ByteSpan bytes);

/// The chunk that a file was cut off in. Nothing vouches for what is there: its checksum is cut
/// off.
struct TornChunk {
  ChunkType type = ChunkType::end;
  std::uint64_t size = 0;  ///< of the whole payload, as the chunk states it
  ByteSpan payload;        ///< what is left of it: at most `size` bytes
  std::size_t offset = 0;  ///< of the payload in the file
};

/// A file as far as it is there.
struct PartialContainer {
  bool complete = false;          ///< the end chunk was found: nothing is missing
  std::vector<Chunk> chunks;      ///< those that are whole, as read_container gives them
  std::optional<TornChunk> torn;  ///< none if complete or cut before the size of a chunk is known
  std::size_t cut_chunk = 0;      ///< where in the file the first chunk begins that is not whole
};

/// Reads a file that may be cut off anywhere after its header. A damaged length may look like a
/// cut; all other damage to whole chunks is an error. Errors and cost as read_container.
Result<PartialContainer> read_container_prefix(ByteSpan bytes);

/// The first chunk of a type that may be absent; null if it is.
const Chunk* find_chunk(const std::vector<Chunk>& chunks, ChunkType type);
/// All chunks of a type that may repeat, in file order.
std::vector<Chunk> find_chunks(const std::vector<Chunk>& chunks, ChunkType type);
/// The chunk of a type that must be there; corrupt if it is not.
Result<Chunk> require_chunk(const std::vector<Chunk>& chunks, ChunkType type);

}  // namespace curlidar
