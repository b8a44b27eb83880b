// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sensor/cones.hpp"

namespace curlidar {

/// Firings in a full turn, from the steps of azimuth within the fullest rings; 0 if there are too
/// few returns to tell. O(n log n).
double columns_from_steps(const Returns& returns, const Labels& labels);

/// The number that data sheets state where one is within 2 percent.
std::uint32_t usual_columns(double columns);

}  // namespace curlidar
