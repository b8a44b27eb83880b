// SPDX-License-Identifier: BSD-3-Clause
// Every parameter of the profiles, with its default and its unit.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/project.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// How the field is made.
enum class Profile {
  paper,         ///< CURL, RSS 2022: mesh, upsampling, patches of adaptive degree
  paper_1to1,    ///< the same, tuned for 1:1 reconstruction (no upsampling, tight acceptance)
  paper_global,  ///< the paper's baseline: one degree-64 expansion of the whole scan
  compact,       ///< inverse-range fields on an adaptive partition: the smallest files
};
const char* to_string(Profile profile);  ///< "compact", "paper", "paper-1to1", "paper-global"
Result<Profile> profile_by_name(std::string_view name);

/// What the size of a compact file is balanced against.
enum class CompactTarget {
  error,           ///< mean distance of decoded returns to their own original ones, metres
  error_nn,        ///< the larger of the two mean nearest-neighbour distances, metres
  step,            ///< the field's step D, metres: one encoding, no search
  bits_per_point,  ///< all bytes but attributes and metadata, in bits per coded return
  max_error,       ///< a bound on the distance of every decoded return to its original, metres:
                   ///< checked before the file is written, and kept in it
  lossless,        ///< coordinates come back bit for bit; target_value is ignored
};

/// Which returns a compact file holds.
enum class Coverage {
  automatic,     ///< every return, unless columns or limits of range are given
  every_return,  ///< all of them, in their slots: NaN and zero points keep their places
  image,         ///< those of a depth image: one a cell, within the limits
};

/// Parameters of Profile::compact. Rows are always the true rings.
struct CompactSettings {
  Coverage coverage = Coverage::automatic;
  /// Every return: keep the order of the points, and empty slots. False writes cell by cell.
  bool keep_order = true;
  /// Columns of an image's turn; 0 = those of an organised cloud, else kCompactColumns.
  std::uint32_t columns = 0;
  double min_range_m = 0;
  RangeLimit max_range{};  ///< all 0 = everything
  CompactTarget target = CompactTarget::error;
  double target_value = 0.05;  ///< what is reached is at most this, and near it
  std::uint32_t effort = 4;    ///< 1 (fast) .. 9 (smallest)
  /// Segments that can be decoded alone and an index of them.
  bool index = true;
  /// Bands of rows and sectors of columns that make a segment each; 0 = as many as cost 2 % at
  /// most, or one without an index. Roots of 16 x 16 cells start anew in every segment.
  std::uint32_t bands = 0, sectors = 0;
};
/// Columns for clouds that bring none. At 2048 a return lies 0.05 degrees from its cell's middle on
/// average, 15 mm at 20 m, well within the default error; HDL-64E scans keep 92 % of their returns.
inline constexpr std::uint32_t kCompactColumns = 2048;
inline constexpr std::uint32_t kMaxEffort = 9;

/// invalid_argument unless every value makes sense.
Status validate(const CompactSettings& settings);
/// What the coverage comes to.
bool keeps_every_return(const CompactSettings& settings);

/// Distances between neighbouring returns above which the surface is taken to be broken.
struct CliffThresholds {
  double row_m = 2.0;        ///< to the previous row, same column
  double column_m = 0.2;     ///< to the previous column, same row
  double diagonal_m = 2.01;  ///< to the diagonal neighbour
};

/// Parameters of the paper's pipeline (its Table I and notes on its code).
struct PaperSettings {
  RowRule row_rule = RowRule::uniform;
  std::uint32_t rows = 0;        ///< L; 0 = the sensor's ring count
  std::uint32_t columns = 1024;  ///< N_h
  double min_range_m = 5;
  RangeLimit max_range{0, 90};
  double outlier_radius_m = 1;           ///< 0 switches the outlier filter off
  std::uint32_t outlier_min_points = 7;  ///< neighbours within the radius, itself included

  std::uint32_t upsample_rows = 2;      ///< S_row, whole number >= 1
  std::uint32_t upsample_columns = 2;   ///< S_col
  double refused_triangle_share = 0.1;  ///< hits on the largest triangles by area are refused
  CliffThresholds cliffs;

  std::uint32_t patch = 4;          ///< P_r, in original cells, both ways
  std::uint32_t overlap = 2;        ///< extended cells on every side, in upsampled cells
  std::uint32_t max_degree = 100;   ///< of a patch; more than 24 add nothing (256 functions)
  double accept_m = 0.5;            ///< a degree is accepted at this mean training error
  double reject_m = 0.5;            ///< samples this far off are removed after the first pass
  double k = 9;                     ///< degree at which training and testing errors weigh the same
  bool stop_on_total_error = true;  ///< stop when the weighted error E_t rises

  std::uint32_t global_degree = 64;  ///< of Profile::paper_global
  double global_reject_m = 0.5;      ///< its reconstructed cells this far off are masked
};

/// "outdoor" (default), "indoor", "newer-college", "superrso".
Result<PaperSettings> paper_preset(std::string_view name);
std::vector<std::string> paper_preset_names();
/// The preset for a scan that nobody has chosen one for: "indoor" if more than half of its returns
/// lie nearer than the 5 m at which "outdoor" begins, else "outdoor". O(n).
std::string suggest_preset(const Cloud& cloud);

/// A preset's settings as the given profile starts from them (paper-1to1: S 1x1, accept 0.01 m,
/// reject 0.05 m, no overlap, no E_t stop). Apply it before changes of your own: `encode` takes
/// EncodeSettings::paper as it is.
PaperSettings for_profile(PaperSettings settings, Profile profile);

}  // namespace curlidar
