// SPDX-License-Identifier: BSD-3-Clause
// What the decoded neighbours of a cell say about its range. Integers only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace curlidar {

/// Ways to predict a range; their blend is what residuals are taken from.
inline constexpr std::size_t kResidualPredictors = 6;

/// The prediction of one cell's range, in 1/65536 m throughout.
struct RangePrediction {
  std::int32_t range = 0;   ///< the blend of the predictors
  std::int32_t spread = 0;  ///< mean |error| to expect of it
  std::array<std::int32_t, kResidualPredictors> each{};
  std::array<std::int32_t, kResidualPredictors> each_spread{};
  std::array<std::int32_t, 4> last_error{};  ///< of the blend at W, N, NW, NE; 0 where unknown
  std::uint32_t known = 0;                   ///< bit set of W, N, NW, NE: has a coded range
  std::uint32_t same = 0;                    ///< the same, and is of the cell's own surface
};

/// Walks a segment in raster order.
class ResidualPredictor {
 public:
  ResidualPredictor(std::size_t columns, std::int32_t step);

  void start_row();
  /// Predicts the range of a cell from its field and the cells learnt before.
  void predict(std::size_t column, std::int32_t field, std::int32_t surface,
               RangePrediction& prediction);
  /// Takes in the decoded range of the cell predicted last.
  void learn(std::size_t column, std::int32_t range, const RangePrediction& prediction);

 private:
  static constexpr std::size_t kNeighbours = 11;
  static constexpr std::size_t kPad = 3;

  struct Cell {
    bool known = false;
    std::int32_t surface = 0;
    std::int32_t range = 0;
    std::int32_t deviation = 0;                                 ///< range - field
    std::array<std::int32_t, kResidualPredictors + 1> error{};  ///< of each predictor; of the blend
  };

  Cell& cell(std::size_t rows_up, std::size_t column) {
    return lines_[(row_ + 3 - rows_up) % 3 * (columns_ + 2 * kPad) + column + kPad];
  }
  void gather(std::size_t column);
  void measure_spreads(RangePrediction& prediction) const;
  std::int32_t damped_mean(std::int32_t surface) const;
  std::int32_t filtered(std::int32_t centre, std::int32_t spread);
  void teach_filter(std::int32_t deviation);
  std::int32_t texture(std::int32_t field) const;
  void blend(RangePrediction& prediction) const;

  std::size_t columns_;
  std::int32_t step_;
  std::size_t row_ = 0;
  std::vector<Cell> lines_;  ///< three rows, each with kPad unknown cells at both ends

  // Of the cell being predicted.
  std::int32_t field_ = 0, surface_ = 0;
  std::array<const Cell*, kNeighbours> near_{};
  std::array<std::int32_t, kNeighbours> inputs_{};
  std::int32_t centre_ = 0, clip_ = 0, upper_ = 0;
  bool has_upper_ = false;

  // Learnt.
  std::array<std::int32_t, kNeighbours> weights_{};  ///< 1 = 65536
  std::array<std::int32_t, kResidualPredictors + 1> usual_error_{};
  std::int32_t row_offset_ = 0;  ///< of this row against those above
  std::int32_t row_count_ = 0;
};

}  // namespace curlidar
