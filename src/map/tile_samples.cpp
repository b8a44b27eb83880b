// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/format.h>

namespace curlidar::tile {
namespace {

/// A sample as integers, so that equal places sort alike on every machine.
struct Placed {
  std::uint64_t root = 0;
  std::uint32_t fine = 0;
  Ticks3 at{};
  float weight = 1, intensity = 0;
  bool lit = false;

  auto key() const { return std::tie(root, fine, at, weight, lit, intensity); }
};

constexpr double kLeastWeight = 1.0 / 1024, kMostWeight = 1024;

std::uint32_t morton(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t levels) {
  std::uint32_t out = 0;
  for (std::uint32_t b = levels; b-- > 0;) {
    out = out << 3 | (z >> b & 1) << 2 | (y >> b & 1) << 1 | (x >> b & 1);
  }
  return out;
}

}  // namespace

Result<SortedSamples> sort_samples(const std::vector<MapSample>& samples, TileLayout& layout) {
  const std::int32_t side = layout.edge(0) * static_cast<std::int32_t>(layout.side_roots);
  const double side_m = static_cast<double>(side) / kTicks;
  const double most_z = static_cast<double>(layout.edge(0)) * (kMaxRow - 1) / kTicks;
  std::vector<Placed> placed;
  placed.reserve(samples.size());
  std::int32_t lowest = std::numeric_limits<std::int32_t>::max(), highest = -lowest;
  for (const MapSample& sample : samples) {
    const Vec3& p = sample.position;
    if (!(p.x >= 0 && p.x < side_m && p.y >= 0 && p.y < side_m && std::abs(p.z) < most_z)) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("a sample at ({:g}, {:g}, {:g}) m is outside of its tile of {:g} m",
                               p.x, p.y, p.z, side_m)};
    }
    if (!(sample.weight >= kLeastWeight && sample.weight <= kMostWeight)) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("a sample has the weight {:g}; it must be from {:g} to {:g}",
                               sample.weight, kLeastWeight, kMostWeight)};
    }
    Placed one;
    one.at = {static_cast<std::int32_t>(std::floor(p.x * kTicks)),
              static_cast<std::int32_t>(std::floor(p.y * kTicks)),
              static_cast<std::int32_t>(std::floor(p.z * kTicks))};
    one.weight = sample.weight;
    one.lit = std::isfinite(sample.intensity);
    one.intensity = one.lit ? sample.intensity : 0;
    const std::int32_t row = one.at[2] >> layout.root_log2;
    lowest = std::min(lowest, row);
    highest = std::max(highest, row);
    placed.push_back(one);
  }
  SortedSamples out;
  if (layout.rows > 0) {
    lowest = std::min(lowest, layout.first_row);
    highest = std::max(highest, layout.first_row + static_cast<std::int32_t>(layout.rows) - 1);
  }
  const bool any = highest >= lowest;
  layout.first_row = any ? lowest : 0;
  layout.rows = any ? static_cast<std::uint32_t>(highest - lowest + 1) : 0;
  if (layout.rows > kMaxRoots / (layout.side_roots * layout.side_roots)) {
    return Error{ErrorCode::limit_exceeded,
                 fmt::format("the samples of a tile are {} roots high; at most {} are possible",
                             layout.rows, kMaxRoots / (layout.side_roots * layout.side_roots))};
  }
  const std::uint32_t log2 = layout.root_log2, fine_log2 = layout.fine_log2();
  const std::uint32_t mask = layout.fine(0) - 1;
  for (Placed& one : placed) {
    const auto x = static_cast<std::uint32_t>(one.at[0]), y = static_cast<std::uint32_t>(one.at[1]);
    const auto z = static_cast<std::uint32_t>(one.at[2] - layout.first_row * layout.edge(0));
    one.root =
        (std::uint64_t{x >> log2} * layout.side_roots + (y >> log2)) * layout.rows + (z >> log2);
    one.fine =
        morton(x >> fine_log2 & mask, y >> fine_log2 & mask, z >> fine_log2 & mask, layout.levels);
  }
  std::sort(placed.begin(), placed.end(),
            [](const Placed& a, const Placed& b) { return a.key() < b.key(); });
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Placed& one = placed[i];
    if (i == 0 || one.root != placed[i - 1].root) {
      const auto column = static_cast<std::uint32_t>(one.root / layout.rows);
      out.roots.push_back({{0,
                            {column / layout.side_roots, column % layout.side_roots,
                             static_cast<std::uint32_t>(one.root % layout.rows)}},
                           i,
                           i});
    }
    out.roots.back().end = i + 1;
    for (std::size_t k = 0; k < 3; ++k) out.samples.at[k].push_back(one.at[k]);
    out.samples.weight.push_back(static_cast<double>(one.weight));
    out.samples.intensity.push_back(one.lit ? one.intensity
                                            : std::numeric_limits<float>::quiet_NaN());
    out.samples.fine.push_back(one.fine);
  }
  return out;
}

void weigh_left(TileSamples& samples) {
  samples.left.clear();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples.left.push_back(samples.weight[i] * samples.drop[i]);
  }
}

void limit_weights(SortedSamples& sorted, double most) {
  TileSamples& samples = sorted.samples;
  for (const RootSamples& root : sorted.roots) {
    for (std::size_t begin = root.begin, end = begin; begin < root.end; begin = end) {
      double sum = 0;
      while (end < root.end && samples.fine[end] == samples.fine[begin])
        sum += samples.weight[end++];
      if (sum <= most) continue;
      for (std::size_t i = begin; i < end; ++i) samples.weight[i] *= most / sum;
    }
  }
}

}  // namespace curlidar::tile
