// SPDX-License-Identifier: BSD-3-Clause
// What scans of a sensor have taught about the places between given rows. All of it is optional.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/dense.hpp"
#include "curlidar/result.hpp"
#include "dense/trees.hpp"

namespace curlidar {

/// Small integers by row and range. Bins are even in inverse range, as most of what they hold is.
class RangeTable {
 public:
  static constexpr std::size_t kBins = 64;
  static constexpr double kBinScale_m = 192;  ///< the last bin takes all that is nearer than 3.05 m
  using Row = std::array<std::int16_t, kBins>;

  RangeTable() = default;
  explicit RangeTable(std::size_t rows) : rows_(rows, Row{}) {}

  static std::size_t bin(double range_m);

  std::size_t rows() const { return rows_.size(); }
  bool empty() const { return rows_.empty(); }
  Row& row(std::size_t i) { return rows_[i]; }
  const Row& row(std::size_t i) const { return rows_[i]; }
  /// The number for a range above 0.
  double at(std::size_t row, double range_m) const { return rows_[row][bin(range_m)]; }

  friend bool operator==(const RangeTable&, const RangeTable&) = default;

 private:
  std::vector<Row> rows_;
};

/// Numbers that trees of confidence are asked with, which mean the same for every sensor: ratios of
/// ranges, metres, columns, degrees. src/dense/features.cpp lists them.
inline constexpr std::size_t kPlainFeatures = 64;
/// Those, and what a profile knows of the row, that other trees are asked with.
inline constexpr std::size_t kRowFeatures = kPlainFeatures + 9;

/// Rows are those of what is to be predicted, from the top: the rings of a sensor, or the rows of
/// an image. Tables are empty or have them all.
struct DensityProfile {
  std::string name, description;
  std::size_t rows = 0;  ///< 0: none, what is here suits every sensor
  /// Rows first, first + every, .. were given, the others predicted.
  std::size_t given_first = 0, given_every = 1;
  RangeTable elevation_mdeg;   ///< at which a row's returns lie, seen from the origin
  RangeTable return_permille;  ///< how often there is a return where one was interpolated
  /// The same of given rows, as if they had been left out; other rows do not count.
  RangeTable given_return_permille;
  RangeTable bias_mm;  ///< median of true less interpolated ranges on smooth surfaces

  ObliviousTrees returns;     ///< log odds that there is a return
  ObliviousTrees residual;    ///< of a range on a smooth surface, as a share of it
  ObliviousTrees confidence;  ///< log odds of a surface within 5 cm of what the rules say
  /// The same of what a row would have measured, bias and residual included.
  ObliviousTrees row_confidence;

  bool is_given(std::size_t row) const {
    return row >= given_first && (row - given_first) % given_every == 0;
  }
  /// Radians.
  double elevation(std::size_t row, double range_m) const;
  double return_share(std::size_t row, double range_m) const;
  double given_return_share(std::size_t row, double range_m) const;
  double bias_m(std::size_t row, double range_m) const;

  friend bool operator==(const DensityProfile&, const DensityProfile&) = default;
};

inline constexpr std::size_t kMaxDensityRows = 1024;
inline constexpr std::int16_t kMaxBias_mm = 1000;

/// Checks what everybody who uses it relies on. Errors: invalid_argument.
Status validate(const DensityProfile& profile);

/// TOML text of a valid profile; parse_density_profile gives back the same.
std::string density_profile_text(const DensityProfile& profile);

/// docs/density.md describes the format. `where` names the source in messages, which give the
/// line. Errors: corrupt (not TOML), invalid_argument (unknown key, wrong type, bad value).
Result<DensityProfile> parse_density_profile(std::string_view text, const std::string& where);

/// Errors: not_found.
Result<DensityProfile> builtin_density_profile(std::string_view name);
/// The trees of confidence that suit every sensor, never empty. Read once.
const ObliviousTrees& generic_confidence();

}  // namespace curlidar
