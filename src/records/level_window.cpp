// SPDX-License-Identifier: BSD-3-Clause
#include "records/level_window.hpp"

#include <bit>
#include <cstdlib>

namespace curlidar {
namespace {

/// Neighbours that the mean is taken over, and what they weigh.
struct Neighbour {
  std::int32_t row, column, weight;
};
constexpr std::array<Neighbour, 12> kNeighbours = {{{0, -1, 64},
                                                    {0, -2, 38},
                                                    {0, -3, 22},
                                                    {0, -4, 16},
                                                    {-1, 0, 51},
                                                    {-1, -1, 32},
                                                    {-1, 1, 32},
                                                    {-1, -2, 19},
                                                    {-1, 2, 19},
                                                    {-2, 0, 26},
                                                    {-2, -1, 16},
                                                    {-2, 1, 16}}};
/// Records of both rows after which the rows' means are compared.
constexpr std::int32_t kEnough = 50;
constexpr std::int32_t kMostCount = 200;  ///< that a row's mean is taken over
constexpr std::int32_t kUsual = 20;       ///< level where nothing is known
constexpr std::int64_t kMostLevel16 = 255 * 16;

std::int32_t width_of(std::int64_t value) {
  return static_cast<std::int32_t>(std::bit_width(static_cast<std::uint64_t>(value)));
}

/// About 2 log2(1 + value): the size in bits and the bit below the highest.
std::int32_t half_octaves(std::int64_t value) {
  const std::int64_t x = value + 1;
  const std::int32_t width = width_of(x);
  return 2 * (width - 1) + (width > 1 ? static_cast<std::int32_t>(x >> (width - 2) & 1) : 0);
}

}  // namespace

LevelScan::LevelScan(const RecordGeometry& geometry)
    : geometry_(geometry),
      levels_(geometry.grid.cells()),
      row_mean_(geometry.grid.rows),
      row_count_(geometry.grid.rows),
      loose_left_(geometry.grid.loose) {}

bool LevelScan::next() {
  const CellGrid& grid = geometry_.grid;
  while (cell_ < grid.cells() && grid.occupied[cell_] == 0) ++cell_;
  in_cell_ = cell_ < grid.cells();
  if (in_cell_) {
    row_ = static_cast<std::int64_t>(cell_ / grid.columns);
    column_ = static_cast<std::int64_t>(cell_ % grid.columns);
    range_ = range_at(row_, column_);
    ++cell_;
    return true;
  }
  if (loose_left_ == 0) return false;
  --loose_left_;
  row_ = column_ = 0;
  range_ = 0;
  return true;
}

std::int32_t LevelScan::level_at(std::int64_t row, std::int64_t column) const {
  if (row < 0 || column < 0 || column >= geometry_.grid.columns) return -1;
  return levels_[static_cast<std::size_t>(row * geometry_.grid.columns + column)].level;
}

std::int32_t LevelScan::range_at(std::int64_t row, std::int64_t column) const {
  const CellGrid& grid = geometry_.grid;
  if (row < 0 || column < 0 || row >= grid.rows || column >= grid.columns) return 0;
  const auto cell = static_cast<std::size_t>(row * grid.columns + column);
  if (grid.occupied[cell] == 0) return 0;
  return geometry_.range_q16.empty() ? 1 : std::max(geometry_.range_q16[cell], 1);
}

std::int32_t LevelScan::distance_class(std::int32_t range) const {
  const std::int64_t unit = range_ / 50 + 3277;
  const std::int64_t distance = std::abs(std::int64_t{range} - range_);
  return 10 * distance < 3 * unit ? 0 : distance < unit ? 1 : distance < 4 * unit ? 2 : 3;
}

void LevelScan::weigh(LevelWindow& window) const {
  const std::int64_t unit = std::int64_t{range_} / 32 + 6554;
  std::int64_t weights = 0, sum = 0, squares = 0;
  for (const Neighbour& at : kNeighbours) {
    const std::int64_t row = row_ + at.row, column = column_ + at.column;
    std::int64_t level = level_at(row, column);
    if (level < 0) continue;
    const std::int64_t apart = std::min<std::int64_t>(
        std::abs(std::int64_t{range_at(row, column)} - range_) * 16 / unit, 1023);
    const std::int64_t weight = std::int64_t{at.weight} * 4096 / (256 + apart * apart) + 1;
    level = std::clamp<std::int64_t>(16 * level + lift(row), 0, kMostLevel16);
    weights += weight;
    sum += weight * level;
    squares += weight * level * level;
  }
  if (weights == 0) {
    window.mean16 = 16 * window.left;
    window.spread = 5;
    return;
  }
  const std::int64_t mean = sum / weights;
  window.mean16 = static_cast<std::int32_t>(mean);
  const std::int64_t variance = std::max<std::int64_t>(squares / weights - mean * mean, 0);
  window.spread = std::min(half_octaves(variance >> 6) / 2, 7);
}

/// How much higher, in 1/16, levels are in the current row than in another.
std::int32_t LevelScan::lift(std::int64_t row) const {
  const auto here = static_cast<std::size_t>(row_), there = static_cast<std::size_t>(row);
  if (here == there || row_count_[here] <= kEnough || row_count_[there] <= kEnough) return 0;
  return (row_mean_[here] - row_mean_[there]) >> 4;
}

/// How wrong the means of the neighbours were.
std::int32_t LevelScan::misses() const {
  const auto miss_at = [&](std::int64_t row, std::int64_t column) -> std::int32_t {
    if (level_at(row, column) < 0) return 0;
    return levels_[static_cast<std::size_t>(row * geometry_.grid.columns + column)].miss;
  };
  const std::int32_t sum = 2 * miss_at(row_, column_ - 1) + 2 * miss_at(row_ - 1, column_) +
                           miss_at(row_ - 1, column_ + 1);
  return std::min(half_octaves(sum / 2) * 5 / 8, 7);
}

/// Slopes along and across the row, and which neighbours are missing: those of any row, as the
/// geometry is known beforehand.
std::int32_t LevelScan::shape() const {
  const auto slope = [&](std::int64_t row, std::int64_t column) {
    const std::int32_t range = range_at(row, column);
    if (range == 0) return 0;
    const std::int64_t unit = range_ / 256 + 656;
    const std::int64_t apart = std::int64_t{range} - range_;
    const std::int64_t size = std::abs(apart);
    const int level = 2 * size < unit ? 0 : size < 2 * unit ? 1 : 2;
    return apart < 0 ? 3 - level : 3 + level;  // 1..5
  };
  return ((slope(row_, column_ + 1) * 6 + slope(row_, column_ - 1)) * 6 +
          slope(row_ + 1, column_)) *
             4 +
         distance_class(range_at(row_ - 1, column_));
}

LevelWindow LevelScan::window() const {
  LevelWindow w;
  const auto known_or = [](std::int32_t level, std::int32_t other) {
    return level >= 0 ? level : other;
  };
  if (!in_cell_) {
    w.left = known_or(loose_[0].level, kUsual);
    w.above = w.above_left = w.left2 = known_or(loose_[1].level, w.left);
    w.mean16 = 8 * (w.left + w.above);
    w.misses = std::min(half_octaves(loose_[0].miss + loose_[1].miss), 7);
    w.spread = std::min(half_octaves(std::abs(w.left - w.above)) / 2, 7);
    return w;
  }
  w.row = static_cast<std::int32_t>(row_);
  std::int32_t left = level_at(row_, column_ - 1), above = level_at(row_ - 1, column_);
  std::int64_t left_column = column_ - 1, above_row = row_ - 1;
  if (left < 0) left = level_at(row_, left_column = column_ - 2);
  if (above < 0) above = level_at(above_row = row_ - 2, column_);
  if (left >= 0) w.near_left = distance_class(range_at(row_, left_column));
  if (above >= 0) w.near_above = distance_class(range_at(above_row, column_));
  w.left = left >= 0 ? left : known_or(above, kUsual);
  w.above = known_or(above, w.left);
  w.above_left = known_or(level_at(row_ - 1, column_ - 1), w.above);
  w.left2 = known_or(level_at(row_, column_ - 2), w.left);
  w.range = half_octaves(range_ >> 14);
  weigh(w);
  w.misses = misses();
  w.shape = shape();
  return w;
}

void LevelScan::set(const LevelWindow& window, std::int32_t level) {
  const Level coded{static_cast<std::int16_t>(level),
                    static_cast<std::uint8_t>(std::min(std::abs(level - window.mean16 / 16), 255))};
  if (!in_cell_) {
    loose_ = {coded, loose_[0]};
    return;
  }
  levels_[cell_ - 1] = coded;
  const auto row = static_cast<std::size_t>(row_);
  std::int32_t& count = row_count_[row];
  if (count < kMostCount) ++count;
  row_mean_[row] += (level * 256 - row_mean_[row]) / count;
}

}  // namespace curlidar
