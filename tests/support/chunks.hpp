// SPDX-License-Identifier: BSD-3-Clause
// Small things for tests of the file format.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <vector>

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

}  // namespace curlidar::test
