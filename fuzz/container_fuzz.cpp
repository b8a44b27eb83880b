// SPDX-License-Identifier: BSD-3-Clause
// The container and every plain chunk of a .curl file.
#include <cstddef>
#include <cstdint>
#include <span>

#include "support/chunks.hpp"
#include "support/curl_files.hpp"

/// The input is tried as a file (with its checksums put right, which no fuzzer would find), and
/// after its first byte as the payload of a chunk of that type.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curlidar;
  const ByteSpan bytes = std::as_bytes(std::span(data, size));
  (void)test::read_all_chunks(bytes);
  if (size < kHeaderSize) return 0;
  const auto repaired = test::with_right_checksums(bytes);
  (void)test::read_all_chunks(repaired);
  (void)read_container_prefix(repaired);
  (void)test::read_chunk({static_cast<ChunkType>(data[0]), bytes.subspan(1), 1});
  return 0;
}
