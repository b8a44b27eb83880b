// SPDX-License-Identifier: BSD-3-Clause
// Changes inputs that are made of chunks (tests/hostile/targets/chunks.hpp) without losing where
// each begins, which changes of plain bytes soon do.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "hostile/targets/chunks.hpp"

/// libFuzzer's own changes of `size` bytes, in place, to at most `max_size`.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace curlidar::fuzz {

/// A chunk with a payload of its own.
struct OwnChunk {
  std::uint8_t type = 0;
  std::vector<std::uint8_t> payload;
};

inline void mutate_bytes(std::vector<std::uint8_t>& bytes, std::size_t room) {
  const std::size_t size = bytes.size();
  bytes.resize(std::max<std::size_t>(size + room, 1));
  bytes.resize(LLVMFuzzerMutate(bytes.data(), size, bytes.size()));
}

/// Now and then the order and number of chunks change, or the first `header` bytes, which are no
/// chunk; mostly the payload of one chunk does.
inline std::size_t mutate_chunks(std::size_t header, std::uint8_t* data, std::size_t size,
                                 std::size_t max_size, unsigned seed) {
  const std::uint32_t choice = seed % 16;
  const std::size_t which = seed / 16;
  if (size <= header || data[0] == 0x89 || choice == 0) {
    return LLVMFuzzerMutate(data, size, max_size);
  }
  if (choice == 1) {
    LLVMFuzzerMutate(data, header, header);
    return size;
  }
  test::FuzzInput input(std::as_bytes(std::span(data + header, size - header)));
  std::vector<OwnChunk> chunks;
  for (const test::FuzzChunk& chunk : test::read_fuzz_chunks(input)) {
    OwnChunk own{chunk.type, {}};
    for (const std::byte b : chunk.payload) own.payload.push_back(static_cast<std::uint8_t>(b));
    chunks.push_back(std::move(own));
  }
  const std::size_t at = which % chunks.size();
  if (choice == 2) {
    chunks.erase(chunks.begin() + static_cast<std::ptrdiff_t>(at));
  } else if (choice == 3) {
    chunks.push_back(chunks[at]);
  } else if (choice == 4) {
    std::swap(chunks[at], chunks[which / 7 % chunks.size()]);
  } else {
    mutate_bytes(chunks[at].payload,
                 std::min<std::size_t>(max_size - std::min(size, max_size), 64));
  }
  std::vector<std::byte> out;
  for (const OwnChunk& chunk : chunks) {
    test::write_fuzz_chunk(chunk.type, std::as_bytes(std::span(chunk.payload)), out);
  }
  const std::size_t kept = std::min(out.size(), max_size - header);
  for (std::size_t i = 0; i < kept; ++i) data[header + i] = static_cast<std::uint8_t>(out[i]);
  return header + kept;
}

}  // namespace curlidar::fuzz
