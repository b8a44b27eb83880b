// SPDX-License-Identifier: BSD-3-Clause
#include "codec/ray_columns.hpp"

#include <algorithm>

#include "compact/ray_points.hpp"

namespace curlidar {
namespace {

constexpr std::int64_t kTurn = std::int64_t{1} << 32;
/// A direction so near to a cell's (6e-9 rad) is that cell's.
constexpr std::int64_t kSame = 4;
/// Firings farther apart than so many half usual steps have others missing between them.
constexpr std::uint64_t kWideHalves = 5;

/// From each firing to the next, around the turn, binary angles.
std::vector<std::uint32_t> steps_of(const compact::RayTable& rays) {
  std::vector<std::uint32_t> steps(rays.firings.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::uint32_t next = rays.firings[i + 1 < steps.size() ? i + 1 : 0];
    steps[i] = rays.encoder_angle(next) - rays.encoder_angle(rays.firings[i]);
  }
  return steps;
}

std::uint32_t median(std::vector<std::uint32_t> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

RayColumns::RayColumns(const compact::RowTable& table, std::span<const std::int32_t> range)
    : columns_(static_cast<std::uint32_t>(table.rays->firings.size())) {
  const compact::RayTable& rays = *table.rays;
  const std::vector<std::uint32_t> steps = steps_of(rays);
  usual_step_ = median(steps);
  for (const std::uint32_t step : steps) {
    wide_.push_back(2 * std::uint64_t{step} > kWideHalves * usual_step_ ? 1 : 0);
  }
  seen_.reserve(range.size());
  for (std::uint32_t row = 0; row < rays.rays.size(); ++row) {
    const compact::Ray& ray = rays.rays[row];
    const SinCos up = sin_cos_q30(static_cast<std::uint32_t>(table.elevation[row]));
    const std::uint32_t first_ray = rays.azimuth_of(row, 0);
    std::int64_t begin = 0, last = 0;
    for (std::uint32_t column = 0; column < columns_; ++column) {
      const std::uint32_t azimuth = rays.azimuth_of(row, column);
      const std::int32_t r = range[std::size_t{row} * columns_ + column];
      std::uint32_t point = azimuth;
      if (r > 0 && ray.lateral != 0) {
        point =
            compact::azimuth_on_ray(ray, up, azimuth, compact::exact_range(r, rays.range_unit_q48));
      }
      const std::int64_t seen =
          std::int64_t{azimuth - first_ray} + static_cast<std::int32_t>(point - azimuth);
      if (column == 0) begin = seen;
      last = std::clamp(seen - begin, last, kTurn - 1);
      seen_.push_back(static_cast<std::uint32_t>(last));
    }
    first_.push_back(first_ray + static_cast<std::uint32_t>(begin));
    shift_.push_back(rays.column_shift(row));
  }
}

ColumnPair RayColumns::around(std::uint32_t row, std::uint32_t azimuth) const {
  const std::uint32_t* seen = seen_in(row);
  const std::uint32_t angle = azimuth - first_[row];
  // Never the first: that is at 0.
  const auto next =
      static_cast<std::uint32_t>(std::upper_bound(seen, seen + columns_, angle) - seen);
  ColumnPair pair;
  pair.left = next - 1;
  pair.right = next < columns_ ? next : 0;
  const std::int64_t behind = std::int64_t{angle} - seen[pair.left];
  const std::int64_t ahead = (next < columns_ ? std::int64_t{seen[next]} : kTurn) - angle;
  if (behind <= kSame || ahead <= kSame) {
    (behind <= ahead ? pair.left_weight : pair.right_weight) = 1;
    return pair;
  }
  const std::int64_t n = columns_;
  const std::int64_t firing = ((pair.left - std::int64_t{shift_[row]}) % n + n) % n;
  if (wide_[static_cast<std::size_t>(firing)] == 0) {
    pair.right_weight = static_cast<double>(behind) / static_cast<double>(behind + ahead);
    pair.left_weight = 1 - pair.right_weight;
    return pair;
  }
  const auto reach = static_cast<double>(usual_step_);
  pair.left_weight = std::max(0.0, 1 - static_cast<double>(behind) / reach);
  pair.right_weight = std::max(0.0, 1 - static_cast<double>(ahead) / reach);
  if (pair.left_weight + pair.right_weight == 0) {
    (behind <= ahead ? pair.right : pair.left) = behind <= ahead ? pair.left : pair.right;
  }
  return pair;
}

}  // namespace curlidar
