// SPDX-License-Identifier: BSD-3-Clause
// What a profile is worth on a scan that did not teach it.
#pragma once

#include "dense/density_profile.hpp"
#include "density/row_scan.hpp"

namespace curlidar::density {

/// Of the returns of rows that are not given, predicted in their own directions from the raw
/// returns of those given. Metres; completeness is the share that is told a surface.
struct RowScores {
  double completeness = 0, median_m = 0, p95_m = 0;
  double half_median_m = 0, half_p95_m = 0;  ///< of the most trusted half of all returns
};

/// With the profile, which has the tables, or as if there were none.
RowScores judge_rows(const RowScan& scan, const DensityProfile& profile, bool with_profile);

}  // namespace curlidar::density
