// SPDX-License-Identifier: BSD-3-Clause
// The .curl container: magic, version, checksummed chunks. Written down in docs/format.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// The format version written and read by this library. 0 is the draft before version 1: files of
/// another version are refused.
inline constexpr std::uint8_t kFormatVersion = 0;
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
  metadata = 0x80,
};

inline bool is_ancillary(ChunkType type) {
  return (static_cast<std::uint8_t>(type) & 0x80) != 0;
}
/// "sensor", "metadata", ...; "0x71" for a type without a name.
std::string to_string(ChunkType type);

/// Collects chunks into a file.
class ContainerWriter {
 public:
  ContainerWriter();
  /// Appends a chunk. Known types may be added once each; `end` is added by finish().
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
/// a known chunk twice), unsupported (another version, an unknown critical chunk),
/// limit_exceeded (more than kMaxChunks). O(size), allocates O(chunks).
Result<std::vector<Chunk>> read_container(ByteSpan bytes);

/// The chunk of a type that may be absent; null if it is.
const Chunk* find_chunk(const std::vector<Chunk>& chunks, ChunkType type);
/// The chunk of a type that must be there; corrupt if it is not.
Result<Chunk> require_chunk(const std::vector<Chunk>& chunks, ChunkType type);

}  // namespace curlidar
