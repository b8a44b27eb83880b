// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "curlidar/map.hpp"
#include "format/indexed_file.hpp"
#include "map/surface_tile.hpp"
#include "mapfile/map_header.hpp"

namespace curlidar {
namespace {

bool meet(const MapBox& a, const MapBox& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

void widen(MapBox& box, const MapBox& by) {
  box.low = {std::min(box.low.x, by.low.x), std::min(box.low.y, by.low.y),
             std::min(box.low.z, by.low.z)};
  box.high = {std::max(box.high.x, by.high.x), std::max(box.high.y, by.high.y),
              std::max(box.high.z, by.high.z)};
}

Error with_name(const std::string& name, const Error& error) {
  return {error.code, fmt::format("{}: {}", name, error.message)};
}

/// A decoded tile that knows where it lies.
Result<MapTile> decode_tile(ByteSpan part, const MapHeader& header, const TileLimits& limits,
                            std::uint32_t max_level, const std::string& name) {
  CURLIDAR_TRY_ASSIGN(parts, read_tile_part(part, name));
  auto tile = decode_surface_tile(parts.tile, limits, max_level);
  if (!tile) {
    return with_name(fmt::format("{}: tile {},{}", name, parts.key.x, parts.key.y), tile.error());
  }
  if (tile->side_m != header.tile_side_m) {
    return Error{ErrorCode::corrupt,
                 fmt::format("{}: tile {},{} has a side of {:g} m, the map's "
                             "are {:g} m; the map is damaged",
                             name, parts.key.x, parts.key.y, tile->side_m, header.tile_side_m)};
  }
  tile->key = parts.key;
  tile->origin = tile_origin(parts.key, header);
  return tile;
}

}  // namespace

struct MapFile::State {
  IndexedFile file;
  MapReadOptions options;
  MapHeader header;
  std::vector<MapTileEntry> tiles;
  std::vector<MapScanEntry> scans;
  std::vector<std::size_t> part_of;  ///< of tiles and scans in the file
  std::vector<std::string> missing;

  std::string part_name(std::size_t part) const {
    return fmt::format("{}: byte {}", file.name(), file.entries()[part].offset);
  }
  Status read_entries();
  Status read_entry(std::size_t part);
  Status sort_tiles();
};

/// From the index, or from the part where there is none.
Status MapFile::State::read_entry(std::size_t part) {
  std::vector<std::byte> summary = file.entries()[part].summary;
  const std::string name = part_name(part);
  if (file.missing()) {
    CURLIDAR_TRY_ASSIGN(bytes, file.read(part));
    if (header.kind == MapKind::surface) {
      CURLIDAR_TRY_ASSIGN(tile, decode_tile(bytes, header, options.tile, kAllLevels, name));
      summary = write_tile_summary(tile, header.tile_side_m);
    } else {
      CURLIDAR_TRY_ASSIGN(scan, read_scan_part(bytes, name));
      CURLIDAR_TRY_ASSIGN(decoded, decode(scan.file));
      const ScanExtent extent = extent_of(decoded.points);
      summary = write_scan_summary(scan.T_map_sensor, header, extent.radius_m, extent.points);
    }
  }
  if (header.kind == MapKind::surface) {
    CURLIDAR_TRY_ASSIGN(entry, read_tile_summary(summary, header, name));
    entry.bytes = file.entries()[part].size;
    tiles.push_back(entry);
  } else {
    CURLIDAR_TRY_ASSIGN(entry, read_scan_summary(summary, header, name));
    entry.bytes = file.entries()[part].size;
    scans.push_back(entry);
  }
  part_of.push_back(part);
  return {};
}

Status MapFile::State::read_entries() {
  if (file.missing()) missing.push_back(*file.missing());
  for (std::size_t part = 0; part < file.entries().size(); ++part) {
    const Status read = read_entry(part);
    if (read) continue;
    if (!file.missing()) return read;
    missing.push_back(read.error().message);
  }
  return header.kind == MapKind::surface ? sort_tiles() : Status{};
}

Status MapFile::State::sort_tiles() {
  std::vector<std::size_t> order(tiles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return tiles[a].key < tiles[b].key; });
  std::vector<MapTileEntry> sorted;
  std::vector<std::size_t> parts;
  for (const std::size_t i : order) {
    if (!sorted.empty() && sorted.back().key == tiles[i].key) {
      return Error{ErrorCode::corrupt,
                   fmt::format("{}: tile {},{} is there twice; the map is damaged", file.name(),
                               tiles[i].key.x, tiles[i].key.y)};
    }
    sorted.push_back(tiles[i]);
    parts.push_back(part_of[i]);
  }
  tiles = std::move(sorted);
  part_of = std::move(parts);
  return {};
}

MapFile::MapFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
MapFile::MapFile(MapFile&&) noexcept = default;
MapFile& MapFile::operator=(MapFile&&) noexcept = default;
MapFile::~MapFile() = default;

namespace {

Result<IndexedFile> open_indexed(std::shared_ptr<const RandomAccess> source, bool allow_truncated) {
  CURLIDAR_TRY_ASSIGN(start, source->read(0, std::min<std::uint64_t>(source->size(), 64)));
  const auto kind = indexed_kind(start);
  if (!kind && is_curl(start) && start.size() > 8 && start[8] != std::byte{0x30}) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{}: a .curl file of one scan, not a map; 'curlidar map build' makes "
                             "maps from scans and poses",
                             source->name())};
  }
  if (kind == IndexedKind::sequence) {
    return Error{
        ErrorCode::invalid_argument,
        fmt::format("{}: a sequence of scans, not a map; 'curlidar decode' gives its scans, "
                    "'curlidar map build' makes a map of them",
                    source->name())};
  }
  IndexedOptions options;
  options.allow_truncated = allow_truncated;
  return IndexedFile::open(std::move(source), options);
}

}  // namespace

Result<MapFile> MapFile::open(const std::string& path, const MapReadOptions& options) {
  if (path == "-") {
    CURLIDAR_TRY_ASSIGN(bytes, read_file(path));
    return read(std::move(bytes), "standard input", options);
  }
  CURLIDAR_TRY_ASSIGN(source, open_random_access(path));
  return open_source(std::move(source), options);
}

Result<MapFile> MapFile::read(std::vector<std::byte> bytes, const std::string& name,
                              const MapReadOptions& options) {
  return open_source(random_access_of(std::move(bytes), name), options);
}

Result<MapFile> MapFile::open_source(std::shared_ptr<const RandomAccess> source,
                                     const MapReadOptions& options) {
  CURLIDAR_TRY_ASSIGN(file, open_indexed(std::move(source), options.allow_truncated));
  auto state = std::make_unique<State>(State{std::move(file), options, {}, {}, {}, {}, {}});
  const bool surface = state->file.kind() == IndexedKind::surface_map;
  CURLIDAR_TRY_ASSIGN(header, read_map_header(surface ? MapKind::surface : MapKind::scans,
                                              state->file.header(), state->file.name()));
  state->header = std::move(header);
  CURLIDAR_TRY(state->read_entries());
  return MapFile(std::move(state));
}

const MapHeader& MapFile::header() const {
  return state_->header;
}
const std::vector<MapTileEntry>& MapFile::tiles() const {
  return state_->tiles;
}
const std::vector<MapScanEntry>& MapFile::scans() const {
  return state_->scans;
}
std::uint64_t MapFile::file_bytes() const {
  return state_->file.file_bytes();
}
std::uint64_t MapFile::index_bytes() const {
  return state_->file.index_bytes();
}
const std::vector<std::string>& MapFile::missing() const {
  return state_->missing;
}

std::optional<MapBox> MapFile::extent() const {
  std::optional<MapBox> extent;
  const auto add = [&](const MapBox& box) {
    if (!extent) extent = box;
    widen(*extent, box);
  };
  for (const MapTileEntry& tile : state_->tiles) {
    if (tile.leaves > 0) add(tile.box);
  }
  for (const MapScanEntry& scan : state_->scans) add(scan.box);
  return extent;
}

std::vector<std::size_t> MapFile::parts_in(const MapBox& box) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < state_->tiles.size(); ++i) {
    if (state_->tiles[i].leaves > 0 && meet(state_->tiles[i].box, box)) found.push_back(i);
  }
  for (std::size_t i = 0; i < state_->scans.size(); ++i) {
    if (meet(state_->scans[i].box, box)) found.push_back(i);
  }
  return found;
}

Result<std::vector<std::byte>> MapFile::read_part(std::size_t part) const {
  if (part >= state_->part_of.size()) {
    return Error{ErrorCode::invalid_argument, fmt::format("{}: part {} of {}", state_->file.name(),
                                                          part, state_->part_of.size())};
  }
  return state_->file.read(state_->part_of[part]);
}

Result<MapTile> MapFile::read_tile(std::size_t tile, std::uint32_t max_level) const {
  if (state_->header.kind != MapKind::surface) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{}: a map of scans has no tiles", state_->file.name())};
  }
  const auto bytes = read_part(tile);
  if (!bytes && tile < state_->tiles.size()) {
    const TileKey& key = state_->tiles[tile].key;
    return with_name(fmt::format("tile {},{}", key.x, key.y), bytes.error());
  }
  if (!bytes) return bytes.error();
  const std::string name = state_->part_name(state_->part_of[tile]);
  CURLIDAR_TRY_ASSIGN(decoded,
                      decode_tile(*bytes, state_->header, state_->options.tile, max_level, name));
  if (decoded.key != state_->tiles[tile].key) {
    return Error{ErrorCode::corrupt,
                 fmt::format("{}: another tile than the index says; the map is damaged", name)};
  }
  return decoded;
}

Result<MapScan> MapFile::read_scan(std::size_t scan) const {
  if (state_->header.kind != MapKind::scans) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{}: a surface map has no scans", state_->file.name())};
  }
  CURLIDAR_TRY_ASSIGN(bytes, read_part(scan));
  return read_scan_part(bytes, state_->part_name(state_->part_of[scan]));
}

bool is_map(std::span<const std::byte> bytes) {
  const auto kind = indexed_kind(bytes);
  return kind == IndexedKind::surface_map || kind == IndexedKind::scan_map;
}

}  // namespace curlidar
