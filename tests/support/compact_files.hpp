// SPDX-License-Identifier: BSD-3-Clause
// Compact scans as files, whole and cut off.
#pragma once

#include <utility>
#include <vector>

#include "compact/scan_decoder.hpp"
#include "compact/scan_encoder.hpp"
#include "format/container.hpp"

namespace curlidar::test {

inline std::vector<std::byte> file_of(const std::vector<compact::ScanChunk>& chunks) {
  ContainerWriter writer;
  for (const compact::ScanChunk& chunk : chunks) {
    writer.add(static_cast<ChunkType>(chunk.part), chunk.payload);
  }
  return std::move(writer).finish();
}

/// The scan's chunks of a file that may be cut off.
inline compact::ScanChunks chunks_of(const PartialContainer& file) {
  compact::ScanChunks out;
  out.complete = file.complete;
  const auto add = [&](ChunkType type, ByteSpan payload, std::size_t offset, bool whole) {
    const auto number = static_cast<std::uint8_t>(type);
    if (number < 0x10 || number > 0x16) return;
    out.chunks.push_back({static_cast<compact::ScanPart>(number), payload, offset, whole});
  };
  for (const Chunk& chunk : file.chunks) add(chunk.type, chunk.payload, chunk.offset, true);
  if (file.torn) add(file.torn->type, file.torn->payload, file.torn->offset, false);
  return out;
}

}  // namespace curlidar::test
