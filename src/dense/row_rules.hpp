// SPDX-License-Identifier: BSD-3-Clause
// Along the rows of a known sensor: what its profile adds to the rules.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dense/density_profile.hpp"
#include "dense/features.hpp"
#include "dense/look.hpp"
#include "dense/ring_points.hpp"
#include "dense/rules.hpp"

namespace curlidar {

/// What was found in the direction of a row.
struct RowGuess {
  Look look;
  Guess guess;         ///< with the row's bias; `seen` by the profile
  double returns = 0;  ///< probability of a return
};

/// Whether rings are the given rows of a profile with tables. Errors: invalid_argument.
Status check_rows(const DensityProfile& profile, const RingPoints& points);

/// The rings are the given rows of the profile, which has tables; both must outlive this.
class RowRules {
 public:
  /// `offset_m`: what the rings measured too far and the points have no more; none: nothing.
  RowRules(const RingPoints& points, const DensityProfile& profile,
           std::vector<double> offset_m = {});

  /// What the rules say along a row as seen from the origin, before the profile's say. The
  /// elevation is that at which the row would see what is found.
  RowGuess look_along_row(std::size_t row, double azimuth) const;
  /// The same with it.
  RowGuess guess_along_row(std::size_t row, double azimuth) const;
  /// What trees of the profile are asked with, before the profile's say.
  RowFeatures features(std::size_t row, const RowGuess& found) const;
  /// Adds it to what the rules said along a line that is the row's.
  void judge(std::size_t row, RowGuess& found) const;

  /// The row that sees a place at this range and elevation (from the origin); nothing if none does
  /// within a quarter of the step to the next row.
  std::optional<std::size_t> row_of(double elevation, double range_m) const;

 private:
  /// What must be added to a range so that it is as if interpolated between raw returns.
  double raw_offset_m(const RowGuess& found) const;
  double returns_by_tables(std::size_t row, const RowGuess& found) const;

  const RingPoints& points_;
  const DensityProfile& profile_;
  ScanErrors errors_;
  std::vector<double> offset_m_;
};

}  // namespace curlidar
