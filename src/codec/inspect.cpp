// SPDX-License-Identifier: BSD-3-Clause
// Looking at a file without decoding it.
#include "base/try.hpp"
#include "curlidar/codec.hpp"
#include "format/container.hpp"

namespace curlidar {

bool is_curl(std::span<const std::byte> bytes) {
  return is_container(bytes);
}

Result<std::vector<ChunkInfo>> list_chunks(std::span<const std::byte> bytes) {
  CURLIDAR_TRY_ASSIGN(chunks, read_container(bytes));
  std::vector<ChunkInfo> infos;
  infos.reserve(chunks.size());
  for (const Chunk& chunk : chunks) {
    infos.push_back({to_string(chunk.type), chunk.offset, chunk.payload.size()});
  }
  return infos;
}

}  // namespace curlidar
