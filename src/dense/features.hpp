// SPDX-License-Identifier: BSD-3-Clause
// A line of sight in numbers that trees are asked with.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dense/density_profile.hpp"
#include "dense/look.hpp"
#include "dense/ring_points.hpp"
#include "dense/rules.hpp"

namespace curlidar {

/// What a scan as a whole tells of its errors, metres.
struct ScanErrors {
  double noise_m = 0;   ///< ring_noise_m() of its rings
  double step_m = 0;    ///< of the coded ranges; 0: not coded
  double offset_m = 0;  ///< root mean square of what rings measured too far or too near
  /// By cell: how many are coded with one patch, this one among them. Large patches round less, for
  /// what is left of them fits their surface. Empty: not coded.
  std::vector<std::uint32_t> patch_cells{};
};
ScanErrors errors_of(const RingPoints& points);
/// The points are the field's.
ScanErrors errors_of(const RingPoints& points, const Field& field);

using PlainFeatures = std::array<float, kPlainFeatures>;
using RowFeatures = std::array<float, kRowFeatures>;

/// About 0.5 us.
PlainFeatures plain_features(const RingPoints& points, const Look& look, const Guess& guess,
                             const ScanErrors& errors);

/// `row` is one of the profile's; the profile has tables, and the rings are its given rows.
RowFeatures row_features(const PlainFeatures& plain, const DensityProfile& profile, std::size_t row,
                         const Look& look, const Guess& guess);

}  // namespace curlidar
