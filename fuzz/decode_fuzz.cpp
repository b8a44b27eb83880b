// SPDX-License-Identifier: BSD-3-Clause
// A whole .curl file decoded and, where that works, reconstructed.
#include <cstddef>
#include <cstdint>
#include <span>

#include "curlidar/codec.hpp"
#include "support/chunks.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curlidar;
  const ByteSpan bytes = std::as_bytes(std::span(data, size));
  if (size < kHeaderSize) return 0;
  DecodeLimits limits;
  limits.max_cells = 1u << 14;
  limits.max_bytes = 1u << 20;
  const auto scan = decode(test::with_right_checksums(bytes), limits);
  if (!scan) return 0;
  ReconstructSettings settings;
  settings.max_points = 1u << 14;
  (void)reconstruct(*scan, settings);
  settings.rows = 1.5;
  settings.columns = 0.7;
  settings.masks = false;
  settings.organised = true;
  (void)reconstruct(*scan, settings);
  return 0;
}
