// SPDX-License-Identifier: BSD-3-Clause
// Reading a chunk's payload: bounded numbers and text, errors that name the chunk and the byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/bytes.hpp"
#include "curlidar/result.hpp"
#include "format/container.hpp"

namespace curlidar {

/// A ByteReader over a payload that knows where in the file it is.
class PayloadReader : public ByteReader {
 public:
  explicit PayloadReader(const Chunk& chunk)
      : ByteReader(chunk.payload), type_(chunk.type), start_(chunk.offset) {}

  /// "<chunk> chunk, byte <offset in the file>: <what>".
  Error error(ErrorCode code, std::string_view what) const;
  Error corrupt(std::string_view what) const { return error(ErrorCode::corrupt, what); }

  /// Corrupt if a read went past the end of the payload; `what` was being read.
  Status check(std::string_view what) const;
  /// The same, and corrupt if bytes are left over. For the end of every payload.
  Status finish() const;

  /// A varint of at most `max`; corrupt if larger. `what` is a plural noun: "rings".
  Result<std::uint64_t> read_count(std::string_view what, std::uint64_t max);
  /// UTF-8 of at most `max_bytes`; `what` is a noun: "sensor name".
  Result<std::string> read_text(std::string_view what, std::size_t max_bytes);

 private:
  ChunkType type_;
  std::size_t start_;
};

/// Appends text as read_text reads it; invalid_argument if it is too long or not UTF-8.
Status write_text(ByteWriter& writer, std::string_view what, std::string_view text,
                  std::size_t max_bytes);

/// The text in quotation marks as a message shows it: other bytes than printable ones as \xNN, cut
/// where it is long.
std::string quoted(std::string_view text);

}  // namespace curlidar
