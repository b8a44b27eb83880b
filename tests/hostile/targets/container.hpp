// SPDX-License-Identifier: BSD-3-Clause
// The container, whole and cut off, and every plain chunk of a .curl file.
#pragma once

#include <string>

#include "hostile/targets/input.hpp"
#include "support/chunks.hpp"
#include "support/curl_files.hpp"

namespace curlidar::test {

/// What a reader of prefixes says of a file, against what the reader of whole files says.
inline std::string check_prefix(ByteSpan file) {
  const auto whole = read_container(file);
  const auto prefix = read_container_prefix(file);
  if (!prefix) return whole ? "a whole file has no prefix" : "";
  if (prefix->complete != whole.has_value()) return "complete, and yet not whole";
  if (prefix->cut_chunk > file.size()) return "cut behind the end";
  std::size_t end = kHeaderSize;
  for (const Chunk& chunk : prefix->chunks) {
    if (chunk.offset < end || chunk.offset + chunk.payload.size() > file.size()) {
      return "a chunk lies outside the file";
    }
    end = chunk.offset + chunk.payload.size();
  }
  if (prefix->torn && prefix->torn->payload.size() > prefix->torn->size) {
    return "more is left of a chunk than it holds";
  }
  return "";
}

/// The input is tried as a file, as it is and with its checksums put right (which no fuzzer would
/// find), and after its first byte as the payload of a chunk of that type.
inline std::string container_target(ByteSpan bytes) {
  (void)read_all_chunks(bytes);
  if (std::string fault = check_prefix(bytes); !fault.empty()) return fault;
  if (bytes.size() < kHeaderSize) return "";
  const auto repaired = with_right_checksums(bytes);
  (void)read_all_chunks(repaired);
  (void)read_chunk({static_cast<ChunkType>(bytes[0]), bytes.subspan(1), 1});
  return check_prefix(repaired);
}

}  // namespace curlidar::test
