// SPDX-License-Identifier: BSD-3-Clause
// Every reader of cloud files, by content and forced.
#include <cstddef>
#include <cstdint>
#include <span>

#include "curlidar/io.hpp"

/// The first byte chooses the format: one is forced, or the content tells.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curlidar;
  if (size == 0) return 0;
  constexpr CloudFormat kFormats[] = {CloudFormat::pcd,      CloudFormat::ply, CloudFormat::kitti,
                                      CloudFormat::nuscenes, CloudFormat::npy, CloudFormat::csv};
  ReadOptions options;
  options.limits.max_points = 1u << 16;
  const std::size_t choice = data[0] % (std::size(kFormats) + 1);
  if (choice < std::size(kFormats)) options.format = kFormats[choice];
  (void)parse_cloud(std::as_bytes(std::span(data + 1, size - 1)), "fuzz", options);
  return 0;
}
