// SPDX-License-Identifier: BSD-3-Clause
// Where the next point of a cloud in scan order will be: from the points just before it and from
// those on the scan line beside it. Doubles, the same on every machine (no contraction, fixed
// order).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "records/least_squares.hpp"

namespace curlidar::records {

using Position = std::array<double, 3>;

/// What is expected of one coordinate.
struct Guess {
  double value = 0;
  double last = 0;            ///< where the point before was
  double parallel = 0;        ///< moved on as the line beside did
  double turned = 0;          ///< turned on as the line beside did, on the ray that is known by now
  double slow = 0, fast = 0;  ///< by least squares
  LeastSquares<11>::Features features{};
};

/// Follows the points of a cloud, whose coordinates must be below 2^59 in magnitude. For each:
/// begin(); for each axis guess() and learn(); push().
class PointPredictor {
 public:
  /// Finds the match of the last point: the nearest one of an earlier scan line.
  void begin();
  /// Of coordinate `axis`; those before it are known.
  Guess guess(std::size_t axis, const Position& known) const;
  void learn(std::size_t axis, const Guess& guess, double value);
  /// `errors` are those of the guesses, 0 where there were none.
  void push(const Position& point, const Position& errors);

  /// Mean error of late on the axis.
  double recent_error(std::size_t axis) const { return recent_[axis]; }
  /// Of the point before.
  double last_error(std::size_t axis) const { return points_.empty() ? 0 : errors_.back()[axis]; }
  /// Near the match; the recent one if there is no match.
  double matched_error(std::size_t axis) const;

 private:
  static constexpr std::ptrdiff_t kNone = -1;

  void find_match();
  double squared_distance(std::ptrdiff_t index) const;

  std::vector<Position> points_, errors_;
  std::vector<std::ptrdiff_t> matches_;  ///< what each point was expected to lie beside
  std::ptrdiff_t match_ = kNone;
  // Of the point to come: the three points before it, those around the match, and what the match's
  // successor was itself matched to.
  Position last_{}, second_{}, third_{}, matched_{}, next_{}, before_{}, after_{}, beyond_{};
  Position turned_{}, spun_{};
  std::array<LeastSquares<11>, 3> slow_, fast_;
  std::array<std::array<double, 3>, 3> misses_ = {{{16, 16, 16}, {16, 16, 16}, {16, 16, 16}}};
  Position recent_{16, 16, 16};
};

}  // namespace curlidar::records
