// SPDX-License-Identifier: BSD-3-Clause
// Between the samples: a decoded scan asked along any line of sight, for any virtual sensor.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "curlidar/field.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// What decides between the samples.
enum class DenseStrategy : std::uint8_t {
  best,   ///< the returns on the rings around a line of sight: the right surface at a jump
  masks,  ///< what the field itself says, by its own masks
};

/// What scans of a sensor have taught about the places between the rings of a sparser one: where
/// its rings look, how often they return, what they measure too far. Opaque.
struct DensityProfile;

/// Names of the profiles that the library carries, sorted. "generic" is in use without being asked
/// for: it tells confidence only.
std::vector<std::string> builtin_density_names();
/// One of them, or a file ending in .toml (docs/density.md). Errors: not_found, io, limit_exceeded
/// (a file of more than 4 MiB), corrupt, invalid_argument with the line.
Result<std::shared_ptr<const DensityProfile>> load_density_profile(const std::string& name_or_path);
/// Whether the rings of the field are those that the profile was given; one without rows, as those
/// that tell confidence alone, fits every field. Errors: invalid_argument, saying which are not.
Status check_density_profile(const DensityProfile& profile, const Field& field);

struct DenseSettings {
  DenseStrategy strategy = DenseStrategy::best;
  /// Tells how often there is a return where the rows of its sensor look that were not given, and
  /// confidence. One that does not fit the field (see above) is left aside.
  std::shared_ptr<const DensityProfile> profile{};
  /// Lines of sight that are those of such a row, within a quarter of the step to the next one, see
  /// what the row would have measured, its own error included: for a virtual sensor that is the
  /// profile's. Anything denser than its rows would be ribbed by it.
  bool rows_of_profile = false;
};

/// The field of a decoded scan made to be asked anywhere. Every member tells of one and the same
/// surface: evaluate_row at a row and column says what range_along says along that line, and NaN
/// where nothing can be guessed, with masks or without. Through the coded returns it passes as the
/// sensor saw them: without what their rings measure too far, and moved by up to half a step of the
/// coding where patches of one surface are made to meet. Between them a surface is interpolated
/// from the returns of the two rings that are above and below as seen from where the line of sight
/// starts, planes exactly; where the two rings saw different surfaces one of them is chosen, never
/// a place between; where neither saw any, there is nothing. A scan without returns says what
/// `field` says. O(cells) to make; 0.4 us a place on a row, 2 to 4 us any line with its confidence.
std::shared_ptr<const Field> dense_field(std::shared_ptr<const Field> field,
                                         const DenseSettings& settings = {});

}  // namespace curlidar
