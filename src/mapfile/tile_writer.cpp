// SPDX-License-Identifier: BSD-3-Clause
#include "mapfile/tile_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "map/surface_tile.hpp"
#include "mapfile/map_header.hpp"

namespace curlidar {
namespace {

/// Where a tile comes from.
struct TileSource {
  bool in_store = false;
  std::optional<std::size_t> in_old;  ///< its number there
};

std::map<TileKey, TileSource> sources_of(const TileStore& store, const MapFile* old) {
  std::map<TileKey, TileSource> sources;
  for (const TileKey key : store.keys()) sources[key].in_store = true;
  if (old == nullptr) return sources;
  for (std::size_t i = 0; i < old->tiles().size(); ++i) sources[old->tiles()[i].key].in_old = i;
  return sources;
}

/// A tile ready to be written; no part if nothing is worth telling.
struct ReadyTile {
  std::vector<std::byte> part, summary;
  std::size_t samples = 0, explained = 0;
  bool kept = false;    ///< the old bytes
  std::string damaged;  ///< what became of an old tile that cannot be read
};

class TileMaker {
 public:
  TileMaker(const MapFile* old, const MapHeader& header) : old_(old), header_(header) {}

  Result<ReadyTile> make(TileKey key, const TileSource& source,
                         std::vector<MapSample> samples) const {
    if (!source.in_store) return keep(*source.in_old, {});
    ReadyTile ready;
    if (samples.empty() && !source.in_old) return ready;
    if (samples.empty()) return keep(*source.in_old, {});
    if (source.in_old) {
      auto longer = made_longer(key, *source.in_old, samples);
      if (longer || longer.error().code != ErrorCode::corrupt) return longer;
      ready.damaged =
          fmt::format("{}; it was made anew from the new scans alone", longer.error().message);
    }
    ready.samples = samples.size();
    CURLIDAR_TRY_ASSIGN(
        bytes, encode_surface_tile(std::move(samples), header_.surface, header_.tile_side_m));
    CURLIDAR_TRY(finish(key, bytes, ready));
    return ready;
  }

 private:
  /// An old tile with what is new in it.
  Result<ReadyTile> made_longer(TileKey key, std::size_t old,
                                const std::vector<MapSample>& samples) const {
    // Reading the tile finds what is wrong with it.
    CURLIDAR_TRY(old_->read_tile(old));
    CURLIDAR_TRY_ASSIGN(part, old_->read_part(old));
    CURLIDAR_TRY_ASSIGN(parts, read_tile_part(part, "a tile"));
    CURLIDAR_TRY_ASSIGN(longer, append_surface_tile(parts.tile, samples, header_.surface));
    ReadyTile ready;
    ready.samples = samples.size();
    ready.explained = longer.explained;
    if (longer.bytes.empty()) return keep(old, std::move(ready));
    CURLIDAR_TRY(finish(key, longer.bytes, ready));
    return ready;
  }

  /// Part and summary; none for a tile without leaves.
  Status finish(TileKey key, ByteSpan bytes, ReadyTile& ready) const {
    CURLIDAR_TRY_ASSIGN(tile, decode_surface_tile(bytes));
    if (tile.leaves.empty()) return {};
    tile.key = key;
    ready.part = write_tile_part(key, bytes);
    ready.summary = write_tile_summary(tile, header_.tile_side_m);
    return {};
  }

  /// The old tile as it is.
  Result<ReadyTile> keep(std::size_t tile, ReadyTile ready) const {
    ready.kept = true;
    auto part = old_->read_part(tile);
    auto decoded = old_->read_tile(tile);
    if (!part || !decoded) {
      const Error& error = part ? decoded.error() : part.error();
      if (error.code == ErrorCode::io) return error;
      ready.damaged = error.message + "; it was left out";
      return ready;
    }
    ready.part = *std::move(part);
    ready.summary = write_tile_summary(*decoded, header_.tile_side_m);
    return ready;
  }

  const MapFile* old_;
  const MapHeader& header_;
};

/// The samples of a tile, without those of things that moved.
Result<std::vector<MapSample>> still_samples(TileStore& store, TileKey key,
                                             const StillFilter* still, const MapHeader& header,
                                             MapReport& report) {
  CURLIDAR_TRY_ASSIGN(samples, store.take(key));
  if (still == nullptr) return samples;
  std::vector<Vec3> points;
  points.reserve(samples.size());
  for (const MapSample& sample : samples) {
    points.push_back(tile_origin(key, header) + sample.position);
  }
  CURLIDAR_TRY_ASSIGN(moved, still->moved(points));
  std::vector<MapSample> kept;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (moved[i] == 0) kept.push_back(samples[i]);
  }
  report.moved += samples.size() - kept.size();
  return kept;
}

Status write_ready(ReadyTile& ready, IndexedWriter& writer, MapReport& report) {
  report.samples += ready.samples;
  report.explained += ready.explained;
  if (!ready.damaged.empty()) report.notes.push_back(std::move(ready.damaged));
  if (ready.part.empty()) return {};
  ++report.tiles;
  if (ready.kept) ++report.tiles_kept;
  return writer.add(ready.part, ready.summary);
}

}  // namespace

Status write_tiles(TileStore& store, const MapFile* old, const StillFilter* still,
                   const MapHeader& header, IndexedWriter& writer, std::size_t threads,
                   MapReport& report, const ProgressCallback& progress) {
  const auto sources = sources_of(store, old);
  const TileMaker maker(old, header);
  const std::size_t batch = resolve_threads(threads);
  std::size_t done = 0;
  for (auto next = sources.begin(); next != sources.end();) {
    std::vector<std::pair<TileKey, TileSource>> work;
    std::vector<std::vector<MapSample>> samples;
    for (; next != sources.end() && work.size() < batch; ++next) {
      work.push_back(*next);
      samples.emplace_back();
      if (!next->second.in_store) continue;
      CURLIDAR_TRY_ASSIGN(taken, still_samples(store, next->first, still, header, report));
      samples.back() = std::move(taken);
    }
    std::vector<Result<ReadyTile>> ready(work.size(), ReadyTile{});
    parallel_for(work.size(), threads, [&](std::size_t i) {
      ready[i] = maker.make(work[i].first, work[i].second, std::move(samples[i]));
    });
    for (Result<ReadyTile>& tile : ready) {
      if (!tile) return tile.error();
      CURLIDAR_TRY(write_ready(*tile, writer, report));
    }
    done += work.size();
    if (progress)
      progress("tiles", static_cast<double>(done) / static_cast<double>(sources.size()));
  }
  return {};
}

}  // namespace curlidar
