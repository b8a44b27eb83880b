// SPDX-License-Identifier: BSD-3-Clause
// The golden surface map: golden tiles of tests/golden/surface, placed in a map.
#pragma once

#include <fstream>
#include <iterator>
#include <string>

#include "curlidar/map.hpp"
#include "format/indexed_file.hpp"
#include "map/surface_tile.hpp"
#include "mapfile/map_header.hpp"

namespace curlidar::test {

inline std::string golden_text(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Which golden tile lies where; in the order of the file, which sorts them.
struct PlacedTile {
  const char* name;
  TileKey key;
};
inline constexpr PlacedTile kPlacedTiles[] = {
    {"box-deep", {-1, 2}}, {"plane", {0, 0}}, {"nothing", {0, 1}}, {"sphere-curves", {70000, -3}}};

inline MapHeader golden_header() {
  MapHeader header;
  header.origin = {458000, 5432100, 112};
  header.tile_side_m = 16;
  header.surface.curves = header.surface.intensity = true;
  header.surface.intensity_step = 0.25;
  header.scans = 300;
  header.travelled_m = 1234.5;
  header.metadata = {{"place", "Straße"}, {"sensor", ""}};
  return header;
}

/// Writes the map at `path` from the tiles in `folder`.
inline Status write_golden_map(const std::string& folder, const std::string& path) {
  const MapHeader header = golden_header();
  auto bytes = write_map_header(header);
  if (!bytes) return bytes.error();
  auto writer = IndexedWriter::create(path, IndexedKind::surface_map, *bytes);
  if (!writer) return writer.error();
  for (const PlacedTile& placed : kPlacedTiles) {
    const std::string text = golden_text(folder + "/" + placed.name + ".tile");
    const ByteSpan tile = std::as_bytes(std::span(text));
    auto decoded = decode_surface_tile(tile);
    if (!decoded) return decoded.error();
    decoded->key = placed.key;
    const Status added = writer->add(write_tile_part(placed.key, tile),
                                     write_tile_summary(*decoded, header.tile_side_m));
    if (!added) return added;
  }
  const auto size = writer->finish();
  return size ? Status{} : Status{size.error()};
}

}  // namespace curlidar::test
