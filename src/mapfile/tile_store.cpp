// SPDX-License-Identifier: BSD-3-Clause
#include "mapfile/tile_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/bytes.hpp"
#include "base/try.hpp"
#include "mapfile/map_header.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kSampleBytes = 32;

std::vector<std::byte> samples_as_bytes(const std::vector<MapSample>& samples) {
  ByteWriter writer;
  for (const MapSample& sample : samples) {
    writer.write(sample.position.x);
    writer.write(sample.position.y);
    writer.write(sample.position.z);
    writer.write(sample.weight);
    writer.write(sample.intensity);
  }
  return std::move(writer).bytes();
}

void samples_from_bytes(ByteSpan bytes, std::vector<MapSample>& samples) {
  ByteReader reader(bytes);
  while (reader.remaining() >= kSampleBytes) {
    MapSample sample;
    sample.position.x = reader.read<double>();
    sample.position.y = reader.read<double>();
    sample.position.z = reader.read<double>();
    sample.weight = reader.read<float>();
    sample.intensity = reader.read<float>();
    samples.push_back(sample);
  }
}

std::array<double, 3> cube_of(const Vec3& p, double edge_m) {
  return {std::floor(p.x / edge_m), std::floor(p.y / edge_m), std::floor(p.z / edge_m)};
}

}  // namespace

std::vector<MapSample> join_samples(std::vector<MapSample> samples, double thinning_m) {
  const auto before = [&](const MapSample& a, const MapSample& b) {
    return cube_of(a.position, thinning_m) < cube_of(b.position, thinning_m);
  };
  std::stable_sort(samples.begin(), samples.end(), before);
  std::vector<MapSample> joined;
  for (std::size_t begin = 0; begin < samples.size();) {
    Vec3 sum{};
    double weight = 0, bright = 0, brightness = 0;
    std::size_t end = begin;
    for (; end < samples.size() && !before(samples[begin], samples[end]); ++end) {
      const MapSample& sample = samples[end];
      const auto w = static_cast<double>(sample.weight);
      sum = sum + sample.position * w;
      weight += w;
      if (!std::isfinite(sample.intensity)) continue;
      brightness += w * static_cast<double>(sample.intensity);
      bright += w;
    }
    MapSample one = samples[begin];
    if (end - begin > 1) {
      one.position = sum * (1 / weight);
      one.weight = std::min(SampleGrid::kMostWeight, static_cast<float>(weight));
      if (bright > 0) one.intensity = static_cast<float>(brightness / bright);
    }
    joined.push_back(one);
    begin = end;
  }
  return joined;
}

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
  const std::vector<MapSample> samples = tile.grid.samples();
  CURLIDAR_TRY_ASSIGN(offset, file_.append(samples_as_bytes(samples)));
  tile.runs.push_back({offset, samples.size()});
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
  std::vector<MapSample> samples;
  for (const Run& run : tile.runs) {
    CURLIDAR_TRY_ASSIGN(bytes, file_.read(run.offset, run.samples * kSampleBytes));
    samples_from_bytes(bytes, samples);
  }
  const std::vector<MapSample> held = tile.grid.samples();
  tile.grid = SampleGrid(thinning_m_);
  if (samples.empty()) return held;
  samples.insert(samples.end(), held.begin(), held.end());
  return join_samples(std::move(samples), thinning_m_);
}

}  // namespace curlidar
