// SPDX-License-Identifier: BSD-3-Clause
// The header, parts and summaries of map files as bytes (docs/format/curl-map-file-1.md).
#pragma once

#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/map.hpp"

namespace curlidar {

/// Keys of tiles lie within this.
inline constexpr std::int32_t kMostTiles = 1 << 20;

Result<std::vector<std::byte>> write_map_header(const MapHeader& header);
Result<MapHeader> read_map_header(MapKind kind, ByteSpan bytes, const std::string& name);

/// A tile's part: its key, then the tile's own bytes.
std::vector<std::byte> write_tile_part(TileKey key, ByteSpan tile);
struct TilePart {
  TileKey key;
  ByteSpan tile;
};
Result<TilePart> read_tile_part(ByteSpan part, const std::string& name);

/// A scan's part.
std::vector<std::byte> write_scan_part(const RigidMotion& T_map_sensor,
                                       std::optional<double> time_s, ByteSpan file);
Result<MapScan> read_scan_part(ByteSpan part, const std::string& name);
/// The pose as a part tells it: rotations are rounded to 2^-30.
RigidMotion coded_pose(const RigidMotion& T_map_sensor);

/// What the index says of a tile whose leaves are these.
std::vector<std::byte> write_tile_summary(const MapTile& tile, double side_m);
Result<MapTileEntry> read_tile_summary(ByteSpan bytes, const MapHeader& header,
                                       const std::string& name);
std::vector<std::byte> write_scan_summary(const RigidMotion& T_map_sensor, const MapHeader& header,
                                          double radius_m, std::uint32_t points);
Result<MapScanEntry> read_scan_summary(ByteSpan bytes, const MapHeader& header,
                                       const std::string& name);

/// Around a scan's points: a sphere's box.
struct ScanExtent {
  double radius_m = 0;
  std::uint32_t points = 0;
};
ScanExtent extent_of(std::span<const Vec3> points);

/// From a tile's corner to the map's frame.
inline Vec3 tile_origin(TileKey key, const MapHeader& header) {
  return header.origin + Vec3{key.x * header.tile_side_m, key.y * header.tile_side_m, 0};
}

}  // namespace curlidar
