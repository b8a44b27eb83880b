// SPDX-License-Identifier: BSD-3-Clause
// Chunks in the inputs of targets: type, size in two bytes, payload; no checksums, so that a fuzzer
// may change what it likes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "hostile/targets/input.hpp"

namespace curlidar::test {

struct FuzzChunk {
  std::uint8_t type = 0;
  ByteSpan payload;
};

/// All chunks of the input; the last one ends where the input does.
inline std::vector<FuzzChunk> read_fuzz_chunks(FuzzInput& input) {
  std::vector<FuzzChunk> chunks;
  while (!input.empty()) {
    const auto type = static_cast<std::uint8_t>(input.byte());
    const std::size_t size = input.two_bytes();
    chunks.push_back({type, input.take(size)});
  }
  return chunks;
}

inline void write_fuzz_chunk(std::uint8_t type, ByteSpan payload, std::vector<std::byte>& out) {
  const std::size_t size = std::min<std::size_t>(payload.size(), 0xffff);
  out.push_back(static_cast<std::byte>(type));
  out.push_back(static_cast<std::byte>(size & 0xff));
  out.push_back(static_cast<std::byte>(size >> 8));
  out.insert(out.end(), payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(size));
}

}  // namespace curlidar::test
