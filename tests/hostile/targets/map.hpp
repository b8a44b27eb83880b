// SPDX-License-Identifier: BSD-3-Clause
// Map files: whole, cut off, and every tile and scan in them.
#pragma once

#include <string>

#include "curlidar/map.hpp"
#include "hostile/targets/input.hpp"
#include "support/chunks.hpp"

namespace curlidar::test {

/// Opens the bytes as a map and reads all that it says it holds.
inline std::string read_whole_map(ByteSpan bytes, bool allow_truncated) {
  MapReadOptions options;
  options.allow_truncated = allow_truncated;
  options.tile.max_leaves = 1u << 14;
  options.tile.max_cells = 1u << 18;
  const auto map = MapFile::read({bytes.begin(), bytes.end()}, "fuzz", options);
  if (!map) return "";
  if (!allow_truncated && !map->missing().empty()) return "something is missing of a whole map";
  for (std::size_t i = 0; i < map->tiles().size(); ++i) {
    const auto tile = map->read_tile(i);
    if (!tile) continue;
    if (tile->key != map->tiles()[i].key) return "another tile than was asked for";
    for (const MapLeaf& leaf : tile->leaves) {
      if (leaf.first_cell + std::size_t{leaf.cells} * leaf.cells > tile->footprint.size()) {
        return "a footprint reaches beyond its cells";
      }
    }
  }
  for (std::size_t i = 0; i < map->scans().size(); ++i) (void)map->read_scan(i);
  (void)map->extent();
  return "";
}

/// The input as it is, and with its checksums put right, which no fuzzer would find; each as a
/// whole map and as one that may be cut off.
inline std::string map_target(ByteSpan bytes) {
  for (const bool cut : {false, true}) {
    if (std::string fault = read_whole_map(bytes, cut); !fault.empty()) return fault;
  }
  if (bytes.size() < kHeaderSize) return "";
  const auto repaired = with_right_checksums(bytes);
  for (const bool cut : {false, true}) {
    if (std::string fault = read_whole_map(repaired, cut); !fault.empty()) return fault;
  }
  return "";
}

}  // namespace curlidar::test
