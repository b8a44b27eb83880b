// SPDX-License-Identifier: BSD-3-Clause
// What the decoded neighbours of a cell say about its range. Integers only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace curlidar::compact {

/// Guesses at a range: the field alone, the field plus what its neighbours deviate from it (a
/// damped mean; that refined by an adaptive filter, by this row, by the rows above), and the
/// neighbours' ranges without the field.
enum class Guess : std::uint8_t { field, mean, filter, left, above, texture };
inline constexpr std::size_t kGuesses = 6;

/// The prediction of one cell's range; lengths in 1/65536 m.
struct RangePrediction {
  std::array<std::int32_t, kGuesses> guess{};
  std::array<std::int32_t, kGuesses> spread{};  ///< mean |error| to expect of each guess
  std::int32_t blend = 0;                       ///< the guesses, weighted by their spreads
  std::int32_t blend_spread = 0;
  std::int32_t last_error_left = 0;   ///< of the blend at W; 0 if W is unknown
  std::int32_t last_error_above = 0;  ///< the same at N
  std::uint32_t grade_left = 0;   ///< of W: 0 unknown, 1 of another surface, 2 of the same surface
  std::uint32_t grade_above = 0;  ///< the same of N

  std::int32_t of(Guess which) const { return guess[static_cast<std::size_t>(which)]; }
  std::int32_t spread_of(Guess which) const { return spread[static_cast<std::size_t>(which)]; }
};

/// Walks a segment in raster order: start_row() before every row, then predict() and learn() for
/// each cell that has a residual.
class ResidualPredictor {
 public:
  static constexpr std::size_t kNeighbours = 11;
  ResidualPredictor(std::size_t columns, std::int32_t step);

  void start_row();
  /// Predicts the range of a cell from its field (in [1, 2^30]) and the cells learnt before.
  void predict(std::size_t column, std::int32_t field, std::int32_t surface,
               RangePrediction& prediction);
  /// Takes in the decoded range (in [1, 2^30]) of the cell that was predicted last.
  void learn(std::size_t column, std::int32_t range, const RangePrediction& prediction);

  /// Weights of the adaptive filter, 1 = 65536, as in the table of priors: for each set of W, N,
  /// NW, NE (1, 2, 4, 8) on the cell's surface, those of all neighbours.
  std::span<std::int32_t> filter_weights() { return weights_; }

 private:
  static constexpr std::size_t kPad = 3;

  struct Cell {
    bool known = false;
    std::int32_t surface = 0;
    std::int32_t range = 0;
    std::int32_t deviation = 0;                      ///< range - field
    std::array<std::int32_t, kGuesses + 1> error{};  ///< |range - guess|; of the blend
  };

  Cell& cell(std::size_t rows_up, std::size_t column) {
    return lines_[(row_ + 3 - rows_up) % 3 * (columns_ + 2 * kPad) + column + kPad];
  }
  void gather(std::size_t column, std::int32_t surface, RangePrediction& prediction);
  void measure_spreads(RangePrediction& prediction) const;
  std::int32_t damped_mean(std::int32_t surface) const;
  std::int32_t weighted(const std::array<std::int32_t, kNeighbours>& weights) const;
  std::int32_t filtered() const;
  void teach_filter(std::int32_t deviation);
  void teach_row_offset(std::int32_t deviation, std::int32_t spread);
  std::int32_t texture(std::int32_t field) const;
  std::int32_t blend(const RangePrediction& prediction) const;

  std::size_t columns_;
  std::int32_t step_;
  std::size_t row_ = 0;
  std::vector<Cell> lines_;  ///< three rows, each with kPad unknown cells at both ends

  // Of the cell being predicted.
  std::int32_t field_ = 0, surface_ = 0;
  std::array<const Cell*, kNeighbours> near_{};
  std::array<std::int32_t, kNeighbours> deviation_{};  ///< as it would be in this row; 0 if unknown
  std::int32_t centre_ = 0;                            ///< their damped mean
  std::int32_t clip_ = 0;
  std::array<std::int32_t, kNeighbours> input_{};  ///< deviation_ - centre_ within +-clip_
  std::size_t filter_set_ = 0;                     ///< index of the first of its weights
  std::int32_t above_ = 0;                         ///< what the rows above say the deviation is

  // Learnt.
  std::array<std::int32_t, 16 * kNeighbours> weights_{};
  std::array<std::int32_t, kGuesses + 1> usual_error_{};
  std::int32_t row_offset_ = 0;       ///< of this row's deviations against those above
  std::int32_t last_row_offset_ = 0;  ///< the same of the row before
  std::int32_t row_count_ = 0;        ///< what row_offset_ rests on
};

}  // namespace curlidar::compact
