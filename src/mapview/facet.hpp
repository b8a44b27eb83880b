// SPDX-License-Identifier: BSD-3-Clause
// A plane over a rectangle, and what of it is nearest to a point.
#pragma once

#include <array>
#include <optional>

namespace curlidar {

/// w = height + slope_u u + slope_v v.
struct Facet {
  double height, slope_u, slope_v;
};

struct Rectangle {
  double u0, u1, v0, v1;
};

/// (u, v) of the place that is nearest to a point (u, v, w), of those above the rectangle with
/// |w| <= reach; none if there is no such place. Exact.
std::optional<std::array<double, 2>> nearest_on_facet(const Facet& facet,
                                                      const Rectangle& rectangle, double reach,
                                                      const std::array<double, 3>& point);

}  // namespace curlidar
