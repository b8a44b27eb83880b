// SPDX-License-Identifier: BSD-3-Clause
#include "compact/cell_finder.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace curlidar::compact {
namespace {

/// No row is steeper: 89.9965 degrees.
constexpr std::int64_t kSteepest = std::int64_t{1} << 30;
constexpr std::int64_t kAnglePerRadian = 683565276;  // round(2^32 / 2 pi)
/// Places nearer to the spin axis are seen by no cell, Q16 metres.
constexpr std::int64_t kNearestLevel = 1 << 12;

std::int64_t slope_of(std::int32_t elevation) {
  const SinCos e = sin_cos_q30(static_cast<std::uint32_t>(elevation));
  if (e.cos <= 0) return e.sin > 0 ? kSteepest : -kSteepest;
  return std::clamp((std::int64_t{e.sin} * 65536) / e.cos, -kSteepest, kSteepest);
}

/// atan(t) for t in [0, 1], Q30 to binary angle: atan(1/2) and the series of what lies beyond it.
std::int64_t arc_of(std::int64_t t) {
  constexpr std::int64_t one = std::int64_t{1} << 30;
  constexpr std::int64_t kArcOfHalf = 316933406;  // round(2^32 atan(1/2) / 2 pi)
  const std::int64_t x = div_floor((t - one / 2) * one, one + t / 2);  // within 1/2
  const std::int64_t square = (x * x) >> 30;
  std::int64_t arc = 0;
  for (const std::int64_t k : {13, 11, 9, 7, 5, 3}) arc = (square * (one / k - arc)) >> 30;
  arc = x - ((x * arc) >> 30);
  return kArcOfHalf + ((arc * kAnglePerRadian) >> 30);
}

}  // namespace

std::uint32_t azimuth_of(std::int64_t x, std::int64_t y) {
  const std::int64_t a = std::abs(x), b = std::abs(y);
  if (a == 0 && b == 0) return 0;
  const std::int64_t arc = b <= a ? arc_of((b << 30) / a) : (1 << 30) - arc_of((a << 30) / b);
  const std::int64_t upper = x >= 0 ? arc : (std::int64_t{1} << 31) - arc;
  return static_cast<std::uint32_t>(y >= 0 ? upper : -upper);
}

CellFinder::CellFinder(const RowTable& table, std::uint32_t rows, std::uint32_t columns)
    : columns_(columns), turn_columns_(table.turn_columns), first_column_(table.first_column) {
  const std::int32_t centre = table.rays ? centre_height(*table.rays) : 0;
  for (std::uint32_t k = 0; k < rows; ++k) {
    Row row;
    row.row = k;
    row.slope = slope_of(table.elevation[k]);
    if (table.rays) {
      const Ray& ray = table.rays->rays[k];
      row.height = std::int64_t{ray.height} - centre;
      row.lateral = ray.lateral;
      row.azimuth_offset = static_cast<std::uint32_t>(ray.azimuth_offset);
      row.shift = table.rays->column_shift(k);
    } else if (!table.height.empty()) {
      row.height = table.height[k];
    }
    sorted_.push_back(row);
    shifts_.push_back(row.shift);
  }
  std::stable_sort(sorted_.begin(), sorted_.end(),
                   [](const Row& a, const Row& b) { return a.slope > b.slope; });
  if (!table.rays) return;
  for (const std::uint32_t firing : table.rays->firings) {
    positions_.push_back(table.rays->encoder_angle(firing) - 0x80000000u);
  }
}

std::int64_t CellFinder::column_at(std::uint32_t row, std::uint32_t encoder_angle) const {
  const std::uint32_t from_start = encoder_angle - 0x80000000u;
  if (positions_.empty()) {
    const std::uint64_t turned = (std::uint64_t{from_start} * turn_columns_ + (1u << 31)) >> 32;
    const std::uint64_t column = (turned + turn_columns_ - first_column_) % turn_columns_;
    return column < columns_ ? static_cast<std::int64_t>(column) : kNowhere;
  }
  const std::size_t n = positions_.size();
  const auto found = std::lower_bound(positions_.begin(), positions_.end(), from_start);
  const auto next = static_cast<std::size_t>(found - positions_.begin()) % n;
  const std::size_t last = (next + n - 1) % n;
  const std::uint32_t before = from_start - positions_[last],
                      behind = positions_[next] - from_start;
  const std::size_t firing = behind < before ? next : last;
  if (std::min(before, behind) > (std::uint64_t{1} << 32) / n) return kNowhere;
  const auto turn = static_cast<std::int64_t>(n);
  return (static_cast<std::int64_t>(firing) + shifts_[row] + turn) % turn;
}

std::int64_t CellFinder::cell_of(const Place& place) const {
  const auto square = static_cast<std::uint64_t>(place.x * place.x + place.y * place.y);
  const auto level = static_cast<std::int64_t>(isqrt(square));
  if (level < kNearestLevel) return kNowhere;
  std::size_t low = 0, high = sorted_.size() - 1;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (height_at(sorted_[middle], level) >= place.z ? low : high) = middle;
  }
  const std::int64_t above = height_at(sorted_[low], level),
                     below = height_at(sorted_[high], level);
  const std::int64_t to_above = std::abs(above - place.z), to_below = std::abs(below - place.z);
  const Row& row = sorted_[to_below < to_above ? high : low];
  const std::int64_t gap = low == high ? level / 32 : std::abs(above - below);
  if (2 * std::min(to_above, to_below) > gap) return kNowhere;
  std::uint32_t angle = azimuth_of(place.x, place.y) - row.azimuth_offset;
  angle -= static_cast<std::uint32_t>(div_floor(row.lateral * kAnglePerRadian, level));
  const std::int64_t column = column_at(row.row, angle);
  return column == kNowhere ? kNowhere : std::int64_t{row.row} * columns_ + column;
}

Sights::Sights(const RowTable& table, std::uint32_t rows, std::uint32_t columns)
    : geometry_(geometry_of(table, {0, 0, rows, columns})), heights_(table.height) {}

}  // namespace curlidar::compact
