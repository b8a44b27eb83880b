// SPDX-License-Identifier: BSD-3-Clause
// Small things for tests of the file format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "base/crc32c.hpp"
#include "format/container.hpp"

namespace curlidar::test {

inline std::vector<std::byte> bytes(std::initializer_list<unsigned> values) {
  std::vector<std::byte> out;
  for (const unsigned value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

/// A chunk with this payload, as if it began at the given byte of a file. Borrows the payload.
inline Chunk chunk_of(ChunkType type, const std::vector<std::byte>& payload,
                      std::size_t offset = 100) {
  return {type, payload, offset};
}

/// The file with right checksums wherever its chunks are whole, so that damage to a payload reaches
/// the payload's reader.
inline std::vector<std::byte> with_right_checksums(ByteSpan file) {
  std::vector<std::byte> out(file.begin(), file.end());
  ByteReader reader(file);
  reader.take(kHeaderSize);
  while (reader.remaining() > 0) {
    const std::size_t start = reader.offset();
    reader.read<std::uint8_t>();
    reader.take(reader.read_varint());
    const std::size_t end = reader.offset();
    reader.read<std::uint32_t>();
    if (!reader.ok()) break;
    const std::uint32_t crc = crc32c(file.subspan(start, end - start));
    for (std::size_t i = 0; i < 4; ++i) {
      out[end + i] = static_cast<std::byte>((crc >> (8 * i)) & 0xff);
    }
  }
  return out;
}

}  // namespace curlidar::test
