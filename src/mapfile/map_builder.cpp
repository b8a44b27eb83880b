// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/try.hpp"
#include "curlidar/map.hpp"
#include "format/indexed_file.hpp"
#include "mapfile/map_header.hpp"
#include "mapfile/spill_file.hpp"
#include "mapfile/still_filter.hpp"
#include "mapfile/tile_store.hpp"
#include "mapfile/tile_writer.hpp"

namespace curlidar {
namespace {

Status check_pose(const RigidMotion& pose) {
  bool finite = true;
  for (const Vec3& v : {pose.rotation[0], pose.rotation[1], pose.rotation[2], pose.move}) {
    finite = finite && std::abs(v.x) < 1e12 && std::abs(v.y) < 1e12 && std::abs(v.z) < 1e12;
  }
  for (std::size_t row = 0; row < 3; ++row) {
    finite = finite && std::abs(norm(pose.rotation[row]) - 1) < 0.01;
  }
  if (finite) return {};
  return Error{ErrorCode::invalid_argument,
               "a pose that is no motion: its numbers are not finite, or its rotation is none"};
}

/// A scan that waits to be written.
struct WaitingScan {
  std::uint64_t offset = 0, size = 0;
  std::vector<std::byte> summary;
};

}  // namespace

struct MapBuilder::State {
  MapBuildSettings settings;
  MapHeader header;
  std::shared_ptr<const MapFile> old;
  bool origin_known = false;
  TileStore store;
  StillFilter still;
  SpillFile scans;
  std::vector<WaitingScan> waiting;
  MapReport report;
  std::optional<Vec3> last_offered, last_taken;

  explicit State(const MapBuildSettings& s, const MapHeader& h)
      : settings(s), header(h), store(h.tile_side_m, h.thinning_m, s.max_samples) {}

  void offer(const Vec3& place) {
    ++report.offered;
    if (last_offered) header.travelled_m += norm(place - *last_offered);
    last_offered = place;
  }
  Status add_surface(const Cloud& cloud, const RigidMotion& T_map_sensor);
  Status add_keyframe(const Cloud& cloud, const RigidMotion& T_map_sensor,
                      std::optional<double> time_s);
  Status write_scans(IndexedWriter& writer);
};

MapBuilder::MapBuilder(std::unique_ptr<State> state) : state_(std::move(state)) {}
MapBuilder::MapBuilder(MapBuilder&&) noexcept = default;
MapBuilder& MapBuilder::operator=(MapBuilder&&) noexcept = default;
MapBuilder::~MapBuilder() = default;

namespace {

Status check_settings_of_build(const MapBuildSettings& settings) {
  if (settings.every_scans == 0 || !(settings.every_m >= 0)) {
    return Error{ErrorCode::invalid_argument,
                 "take every scan, every n-th, or one every few metres"};
  }
  return {};
}

}  // namespace

Result<MapBuilder> MapBuilder::create(const MapBuildSettings& settings) {
  CURLIDAR_TRY(check_settings_of_build(settings));
  MapHeader header = settings.header;
  header.scans = 0;
  header.travelled_m = 0;
  CURLIDAR_TRY(write_map_header(header));
  auto state = std::make_unique<State>(settings, header);
  state->origin_known = !settings.origin_of_first_scan;
  return MapBuilder(std::move(state));
}

Result<MapBuilder> MapBuilder::append(std::shared_ptr<const MapFile> map,
                                      const MapBuildSettings& settings) {
  CURLIDAR_TRY(check_settings_of_build(settings));
  auto state = std::make_unique<State>(settings, map->header());
  for (const auto& [key, value] : settings.header.metadata) {
    state->header.metadata.insert_or_assign(key, value);
  }
  state->origin_known = true;
  state->old = std::move(map);
  return MapBuilder(std::move(state));
}

bool MapBuilder::takes(const RigidMotion& T_map_sensor) const {
  if (state_->report.offered % state_->settings.every_scans != 0) return false;
  return !state_->last_taken ||
         norm(T_map_sensor.move - *state_->last_taken) >= state_->settings.every_m;
}

void MapBuilder::skip(const RigidMotion& T_map_sensor) {
  state_->offer(T_map_sensor.move);
}

Result<bool> MapBuilder::add_scan(const Cloud& cloud, const RigidMotion& T_map_sensor,
                                  std::optional<double> time_s) {
  CURLIDAR_TRY(check_pose(T_map_sensor));
  State& state = *state_;
  const bool taken = takes(T_map_sensor);
  if (!state.origin_known) {
    const Vec3& place = T_map_sensor.move;
    state.header.origin = {std::floor(place.x), std::floor(place.y), std::floor(place.z)};
    state.origin_known = true;
  }
  if (taken) {
    const bool surface = state.header.kind == MapKind::surface;
    CURLIDAR_TRY(surface ? state.add_surface(cloud, T_map_sensor)
                         : state.add_keyframe(cloud, T_map_sensor, time_s));
    state.last_taken = T_map_sensor.move;
    ++state.header.scans;
    ++state.report.taken;
  }
  state.offer(T_map_sensor.move);
  return taken;
}

Status MapBuilder::State::add_surface(const Cloud& cloud, const RigidMotion& T_map_sensor) {
  const Attribute* intensity = header.surface.intensity ? cloud.find("intensity") : nullptr;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.positions[i];
    if (!is_return(p)) continue;
    const double range = norm(p);
    if (range < header.min_range_m || range > header.max_range_m) continue;
    ++report.points;
    const auto bright = intensity != nullptr ? static_cast<float>(intensity->as_double(i))
                                             : std::numeric_limits<float>::quiet_NaN();
    CURLIDAR_TRY(store.add(T_map_sensor(p) - header.origin, bright));
  }
  if (settings.still) CURLIDAR_TRY(still.add_scan(cloud.positions, T_map_sensor));
  return store.settle();
}

Status MapBuilder::State::add_keyframe(const Cloud& cloud, const RigidMotion& T_map_sensor,
                                       std::optional<double> time_s) {
  EncodeSettings scan = settings.scan;
  scan.compact.min_range_m = header.min_range_m;
  scan.compact.max_range = {header.max_range_m, 0};
  scan.threads = settings.threads;
  CURLIDAR_TRY_ASSIGN(encoded, encode(cloud, scan));
  CURLIDAR_TRY_ASSIGN(decoded, decode(encoded.bytes));
  const ScanExtent extent = extent_of(decoded.points);
  report.points += encoded.report.points_in;
  report.samples += extent.points;
  const std::vector<std::byte> part = write_scan_part(T_map_sensor, time_s, encoded.bytes);
  CURLIDAR_TRY_ASSIGN(offset, scans.append(part));
  waiting.push_back({offset, part.size(),
                     write_scan_summary(T_map_sensor, header, extent.radius_m, extent.points)});
  return {};
}

Status MapBuilder::State::write_scans(IndexedWriter& writer) {
  for (std::size_t i = 0; old && i < old->scans().size(); ++i) {
    const auto part = old->read_part(i);
    const auto scan = old->read_scan(i);
    if (!part || !scan) {
      report.notes.push_back((part ? scan.error() : part.error()).message + "; it was left out");
      continue;
    }
    CURLIDAR_TRY_ASSIGN(decoded, decode(scan->file));
    const ScanExtent extent = extent_of(decoded.points);
    CURLIDAR_TRY(writer.add(
        *part, write_scan_summary(scan->T_map_sensor, header, extent.radius_m, extent.points)));
    ++report.tiles;
    ++report.tiles_kept;
  }
  for (const WaitingScan& scan : waiting) {
    CURLIDAR_TRY_ASSIGN(part, scans.read(scan.offset, scan.size));
    CURLIDAR_TRY(writer.add(part, scan.summary));
    ++report.tiles;
  }
  return {};
}

Result<MapReport> MapBuilder::finish(const std::string& path, const ProgressCallback& progress) {
  State& state = *state_;
  const bool surface = state.header.kind == MapKind::surface;
  CURLIDAR_TRY_ASSIGN(header, write_map_header(state.header));
  CURLIDAR_TRY_ASSIGN(
      writer, IndexedWriter::create(
                  path, surface ? IndexedKind::surface_map : IndexedKind::scan_map, header));
  state.report.most_samples = state.store.most_samples();
  if (surface) {
    CURLIDAR_TRY(write_tiles(state.store, state.old.get(),
                             state.settings.still ? &state.still : nullptr, state.header, writer,
                             state.settings.threads, state.report, progress));
  } else {
    CURLIDAR_TRY(state.write_scans(writer));
  }
  CURLIDAR_TRY_ASSIGN(bytes, writer.finish());
  state.report.bytes = bytes;
  return state.report;
}

}  // namespace curlidar
