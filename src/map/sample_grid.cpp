// SPDX-License-Identifier: BSD-3-Clause
#include "map/sample_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace curlidar {
namespace {

constexpr double kMostCubes = 1 << 20;
constexpr double kParts = 65536;

std::size_t hash_of(std::uint64_t key) {
  key *= 0x9e3779b97f4a7c15u;
  return static_cast<std::size_t>(key ^ key >> 32);
}

}  // namespace

SampleGrid::Cell& SampleGrid::cell_of(std::uint64_t key) {
  if (2 * cells_.size() >= places_.size()) widen();
  const std::size_t mask = places_.size() - 1;
  std::size_t at = hash_of(key) & mask;
  for (; places_[at] != 0; at = (at + 1) & mask) {
    KeyedCell& found = cells_[places_[at] - 1];
    if (found.key == key) return found.cell;
  }
  cells_.push_back({key, {}});
  places_[at] = static_cast<std::uint32_t>(cells_.size());
  return cells_.back().cell;
}

void SampleGrid::widen() {
  places_.assign(std::max<std::size_t>(64, 2 * places_.size()), 0);
  const std::size_t mask = places_.size() - 1;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    std::size_t at = hash_of(cells_[i].key) & mask;
    while (places_[at] != 0) at = (at + 1) & mask;
    places_[at] = static_cast<std::uint32_t>(i + 1);
  }
}

bool SampleGrid::add(const Vec3& position, float intensity) {
  const std::array<double, 3> p = {position.x / edge_m_, position.y / edge_m_,
                                   position.z / edge_m_};
  std::uint64_t key = 0;
  std::array<std::int64_t, 3> part{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(std::abs(p[k]) < kMostCubes)) return false;
    const double corner = std::floor(p[k]);
    key = key << 21 | static_cast<std::uint64_t>(static_cast<std::int64_t>(corner + kMostCubes));
    part[k] = static_cast<std::int64_t>((p[k] - corner) * kParts);
  }
  Cell& cell = cell_of(key);
  ++cell.points;
  cell.x += part[0];
  cell.y += part[1];
  cell.z += part[2];
  if (std::isfinite(intensity)) {
    ++cell.with_intensity;
    cell.intensity += std::round(static_cast<double>(intensity) * kParts) / kParts;
  }
  return true;
}

void SampleGrid::add_cell(std::uint64_t key, const Cell& cell) {
  Cell& sum = cell_of(key);
  sum.points += cell.points;
  sum.with_intensity += cell.with_intensity;
  sum.x += cell.x;
  sum.y += cell.y;
  sum.z += cell.z;
  sum.intensity += cell.intensity;
}

std::vector<MapSample> SampleGrid::samples() const {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  order.reserve(cells_.size());
  for (const KeyedCell& one : cells_) {
    order.emplace_back(one.key, static_cast<std::uint32_t>(order.size()));
  }
  std::sort(order.begin(), order.end());
  std::vector<MapSample> out;
  out.reserve(order.size());
  for (const auto& [sorted_key, place] : order) {
    const std::uint64_t key = sorted_key;
    const Cell& cell = cells_[place].cell;
    const auto middle = [&](unsigned shift, std::int64_t sum) {
      const auto corner = static_cast<double>(key >> shift & 0x1fffff) - kMostCubes;
      return (corner + (static_cast<double>(sum) / cell.points + 0.5) / kParts) * edge_m_;
    };
    MapSample sample;
    sample.position = {middle(42, cell.x), middle(21, cell.y), middle(0, cell.z)};
    sample.weight = std::min(kMostWeight, 0.75f + 0.25f * static_cast<float>(cell.points));
    if (cell.with_intensity > 0) {
      sample.intensity = static_cast<float>(cell.intensity / cell.with_intensity);
    }
    out.push_back(sample);
  }
  return out;
}

}  // namespace curlidar
