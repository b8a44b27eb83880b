// SPDX-License-Identifier: BSD-3-Clause
#include "mapfile/tile_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/bytes.hpp"
#include "base/try.hpp"
#include "mapfile/map_header.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kCellBytes = 48;

std::vector<std::byte> cells_as_bytes(const SampleGrid& grid) {
  ByteWriter writer;
  for (const auto& [key, cell] : grid.cells()) {
    writer.write(key);
    writer.write(cell.points);
    writer.write(cell.with_intensity);
    for (const std::int64_t sum : {cell.x, cell.y, cell.z}) {
      writer.write(static_cast<std::uint64_t>(sum));
    }
    writer.write(cell.intensity);
  }
  return std::move(writer).bytes();
}

void add_cells(ByteSpan bytes, SampleGrid& grid) {
  ByteReader reader(bytes);
  while (reader.remaining() >= kCellBytes) {
    const auto key = reader.read<std::uint64_t>();
    SampleGrid::Cell cell;
    cell.points = reader.read<std::uint32_t>();
    cell.with_intensity = reader.read<std::uint32_t>();
    for (std::int64_t* sum : {&cell.x, &cell.y, &cell.z}) {
      *sum = static_cast<std::int64_t>(reader.read<std::uint64_t>());
    }
    cell.intensity = reader.read<double>();
    grid.add_cell(key, cell);
  }
}

}  // namespace

Status TileStore::add(const Vec3& position, float intensity) {
  const double x = std::floor(position.x / side_m_), y = std::floor(position.y / side_m_);
  if (!(std::abs(x) < kMostTiles && std::abs(y) < kMostTiles)) {
    return Error{ErrorCode::limit_exceeded,
                 fmt::format("a point {:g} m, {:g} m from the map's origin lies beyond the largest "
                             "map; check the poses, or set the origin",
                             position.x, position.y)};
  }
  const TileKey key{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
  if (last_ == nullptr || key != last_key_) {
    last_ = &tiles_.try_emplace(key, Tile{SampleGrid(thinning_m_), {}, 0}).first->second;
    last_key_ = key;
    last_->touched = scan_;
  }
  // Rounding must not put a point on the far side of its tile.
  const double most = std::nextafter(side_m_, 0.0);
  const Vec3 local{std::clamp(position.x - x * side_m_, 0.0, most),
                   std::clamp(position.y - y * side_m_, 0.0, most), position.z};
  const std::size_t before = last_->grid.size();
  if (!last_->grid.add(local, intensity)) {
    return Error{ErrorCode::limit_exceeded,
                 fmt::format("a point {:g} m above the map's origin lies beyond the largest map; "
                             "check the poses, or set the origin",
                             position.z)};
  }
  held_ += last_->grid.size() - before;
  most_ = std::max(most_, held_);
  return {};
}

Status TileStore::put_aside(Tile& tile) {
  const std::vector<std::byte> bytes = cells_as_bytes(tile.grid);
  CURLIDAR_TRY_ASSIGN(offset, file_.append(bytes));
  tile.runs.push_back({offset, bytes.size()});
  held_ -= tile.grid.size();
  tile.grid = SampleGrid(thinning_m_);
  return {};
}

Status TileStore::settle() {
  last_ = nullptr;
  ++scan_;
  if (held_ <= max_samples_) return {};
  std::vector<std::pair<std::uint64_t, TileKey>> oldest;
  for (const auto& [key, tile] : tiles_) {
    if (!tile.grid.empty()) oldest.emplace_back(tile.touched, key);
  }
  std::sort(oldest.begin(), oldest.end());
  // More than needed goes at once: not every scan shall write.
  for (const auto& [touched, key] : oldest) {
    if (held_ <= max_samples_ / 4 * 3) break;
    CURLIDAR_TRY(put_aside(tiles_.at(key)));
  }
  return {};
}

std::vector<TileKey> TileStore::keys() const {
  std::vector<TileKey> keys;
  for (const auto& [key, tile] : tiles_) keys.push_back(key);
  return keys;
}

Result<std::vector<MapSample>> TileStore::take(TileKey key) {
  Tile& tile = tiles_.at(key);
  SampleGrid grid = std::exchange(tile.grid, SampleGrid(thinning_m_));
  for (const Run& run : tile.runs) {
    CURLIDAR_TRY_ASSIGN(bytes, file_.read(run.offset, run.bytes));
    add_cells(bytes, grid);
  }
  return grid.samples();
}

}  // namespace curlidar
