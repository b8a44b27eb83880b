// SPDX-License-Identifier: BSD-3-Clause
// What surrounds a record whose level is to be coded: levels known by then, and the geometry.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "records/grid.hpp"

namespace curlidar {

/// The surroundings of one record. Levels lie in [0, 255].
struct LevelWindow {
  std::int32_t row = 0;  ///< 0 for loose records
  /// Of the nearest records there, or a substitute.
  std::int32_t left = 0, left2 = 0, above = 0, above_left = 0;
  std::int32_t mean16 = 0;  ///< 16 times the mean about, by distance in space
  std::int32_t spread = 0;  ///< class of the deviations from it, 0..7
  std::int32_t misses = 0;  ///< class of how wrong the means about were, 0..7
  /// Classes of the distance in range, 0 (near) to 3.
  std::int32_t near_left = 3, near_above = 3;
  std::int32_t range = 0;  ///< class of the range, two an octave, 0..35
  std::int32_t shape = 0;  ///< slopes of the surface and records missing about, below 1024
};

/// Walks over all records in their order.
class LevelScan {
 public:
  explicit LevelScan(const RecordGeometry& geometry);

  /// Whether a record is left; it becomes the current one.
  bool next();
  LevelWindow window() const;
  /// The level of the current record.
  void set(const LevelWindow& window, std::int32_t level);

 private:
  struct Level {
    std::int16_t level = -1;  ///< -1: no record, or not known yet
    std::uint8_t miss = 0;    ///< how far its mean was off
  };

  std::int32_t level_at(std::int64_t row, std::int64_t column) const;
  std::int32_t range_at(std::int64_t row, std::int64_t column) const;
  void weigh(LevelWindow& window) const;
  std::int32_t lift(std::int64_t row) const;
  std::int32_t misses() const;
  std::int32_t shape() const;
  std::int32_t distance_class(std::int32_t range) const;

  const RecordGeometry& geometry_;
  std::vector<Level> levels_;                       ///< of the cells
  std::array<Level, 2> loose_;                      ///< the last two loose ones
  std::vector<std::int32_t> row_mean_, row_count_;  ///< of the levels of each row so far, in 1/256
  std::size_t cell_ = 0;                            ///< the one after the current one
  std::size_t loose_left_ = 0;
  bool in_cell_ = false;
  std::int64_t row_ = 0, column_ = 0;
  std::int32_t range_ = 0;
};

}  // namespace curlidar
