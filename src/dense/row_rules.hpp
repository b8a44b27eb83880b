// SPDX-License-Identifier: BSD-3-Clause
// Along the rows of a known sensor: what its profile adds to the rules.
#pragma once

#include <cstddef>
#include <cstdint>
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
  Guess guess;         ///< `seen` by the profile
  double returns = 0;  ///< probability of a return
};

/// What a profile says along a line of sight.
enum class RowSays : std::uint8_t {
  returns,  ///< how often there is a return
  all,      ///< that, and what the row would have measured, its own error included
};

/// A row that was not given, and whether a line is that of the row or only nearest to it.
struct NearRow {
  std::size_t row = 0;
  bool own = false;
  friend bool operator==(const NearRow&, const NearRow&) = default;
};

/// Whether rings are the given rows of a profile with tables. Errors: invalid_argument.
Status check_rows(const DensityProfile& profile, const RingPoints& points);

/// The rings are the given rows of the profile, which has rows; both must outlive this.
class RowRules {
 public:
  /// `errors` are those of the points. `offset_m`: what the rings measured too far and the points
  /// have no more; none: nothing.
  RowRules(const RingPoints& points, const DensityProfile& profile, ScanErrors errors,
           std::vector<double> offset_m = {});
  /// Of points that were not coded.
  RowRules(const RingPoints& points, const DensityProfile& profile);
  RowRules(const RowRules&) = delete;
  RowRules& operator=(const RowRules&) = delete;

  /// What the rules say along a row as seen from the origin, before the profile's say. The
  /// elevation is that at which the row would see what is found.
  RowGuess look_along_row(std::size_t row, double azimuth) const;
  /// The same with it.
  RowGuess guess_along_row(std::size_t row, double azimuth) const;
  /// What trees of the profile are asked with, before the profile's say.
  RowFeatures features(std::size_t row, const RowGuess& found) const;
  /// Adds it to what the rules said along a line that is the row's or near it. Ranges stay finite
  /// and within a tenth of the rules', whatever the profile.
  void judge(std::size_t row, RowSays says, RowGuess& found) const;

  /// The row nearest to those that see a place at this range and elevation (from the origin), and
  /// whether it does within a quarter of the step to the next one on that side; nothing if that is
  /// a given row, or half a step beyond the outermost.
  std::optional<NearRow> row_near(double elevation, double range_m) const;
  /// What a given row measures too far where the rules say `found` at this elevation (from the
  /// origin), metres; 0 on lines that are not those of a given row.
  double given_offset_m(double elevation, const RowGuess& found) const;

 private:
  /// The row nearest in elevation, given or not.
  struct Nearest {
    std::size_t row = 0;
    double away = 0;  ///< in steps to the next row on that side
  };
  Nearest nearest_to(double elevation, double range_m) const;
  /// What must be added to a range so that it is as if interpolated between raw returns.
  double raw_offset_m(const RowGuess& found) const;
  double returns_by_tables(std::size_t row, const RowGuess& found) const;
  /// What the row would have measured where the rules say `found`.
  double range_of_row(std::size_t row, const RowGuess& found, const RowFeatures& asked) const;

  const RingPoints& points_;
  const DensityProfile& profile_;
  ScanErrors errors_;
  std::vector<double> offset_m_;
};

}  // namespace curlidar
