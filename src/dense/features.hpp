// SPDX-License-Identifier: BSD-3-Clause
// A line of sight in numbers that trees are asked with.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "dense/density_profile.hpp"
#include "dense/look.hpp"
#include "dense/ring_points.hpp"
#include "dense/rules.hpp"

namespace curlidar {

/// Numbers that mean the same for every sensor: ratios of ranges, metres, columns, degrees.
inline constexpr std::size_t kPlainFeatures = 57;
/// Those, and what a profile knows of the row.
inline constexpr std::size_t kRowFeatures = kPlainFeatures + 9;

using PlainFeatures = std::array<float, kPlainFeatures>;
using RowFeatures = std::array<float, kRowFeatures>;

/// `noise_m` is ring_noise_m() of the points. About 0.5 us.
PlainFeatures plain_features(const RingPoints& points, const Look& look, const Guess& guess,
                             double noise_m);

/// `row` is one of the profile's; the profile has tables, and the rings are its given rows.
RowFeatures row_features(const PlainFeatures& plain, const DensityProfile& profile, std::size_t row,
                         const Look& look, const Guess& guess);

}  // namespace curlidar
