// SPDX-License-Identifier: BSD-3-Clause
#include "map/sample_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace curlidar {
namespace {

constexpr double kMostCubes = 1 << 20;
constexpr double kParts = 65536;

}  // namespace

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
  Cell& cell = cells_[key];
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
  Cell& sum = cells_[key];
  sum.points += cell.points;
  sum.with_intensity += cell.with_intensity;
  sum.x += cell.x;
  sum.y += cell.y;
  sum.z += cell.z;
  sum.intensity += cell.intensity;
}

std::vector<MapSample> SampleGrid::samples() const {
  std::vector<std::uint64_t> keys;
  keys.reserve(cells_.size());
  for (const auto& [key, cell] : cells_) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  std::vector<MapSample> out;
  out.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    const Cell& cell = cells_.at(key);
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
