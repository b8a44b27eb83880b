// SPDX-License-Identifier: BSD-3-Clause
#include "format/metadata_chunk.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <utility>

#include "base/bytes.hpp"
#include "base/try.hpp"
#include "format/payload.hpp"

namespace curlidar {
Result<std::vector<std::byte>> write_metadata(const Metadata& metadata) {
  if (metadata.size() > kMaxMetadataEntries) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{} metadata entries, a .curl file holds at most {}", metadata.size(),
                             kMaxMetadataEntries)};
  }
  ByteWriter writer;
  writer.write_varint(metadata.size());
  for (const auto& [key, value] : metadata) {
    if (key.empty()) {
      return Error{ErrorCode::invalid_argument, "a metadata key is empty; name it or remove it"};
    }
    CURLIDAR_TRY(write_text(writer, "metadata key " + quoted(key), key, kMaxMetadataKeyBytes));
    CURLIDAR_TRY(
        write_text(writer, "metadata value of " + quoted(key), value, kMaxMetadataValueBytes));
  }
  return std::move(writer).bytes();
}

Result<Metadata> read_metadata(const Chunk& chunk) {
  PayloadReader reader(chunk);
  CURLIDAR_TRY_ASSIGN(count, reader.read_count("metadata entries", kMaxMetadataEntries));
  Metadata metadata;
  for (std::uint64_t i = 0; i < count; ++i) {
    CURLIDAR_TRY_ASSIGN(key, reader.read_text("metadata key", kMaxMetadataKeyBytes));
    if (key.empty()) return reader.corrupt("a metadata key is empty");
    if (!metadata.empty() && key <= metadata.rbegin()->first) {
      return reader.corrupt("metadata keys are not in ascending order");
    }
    CURLIDAR_TRY_ASSIGN(value, reader.read_text("metadata value", kMaxMetadataValueBytes));
    metadata.emplace_hint(metadata.end(), std::move(key), std::move(value));
  }
  CURLIDAR_TRY(reader.finish());
  return metadata;
}

}  // namespace curlidar
