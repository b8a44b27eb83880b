// SPDX-License-Identifier: BSD-3-Clause
// Labels of returns that the cloud itself suggests: candidates for rings, to be checked as cones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "sensor/cones.hpp"

namespace curlidar {

/// The attribute that numbers the beams, if there is one with usable whole numbers.
const Attribute* find_ring_attribute(const Cloud& cloud);

/// Labels from that attribute; nothing if its values at the returns are not ring numbers.
std::optional<Labels> labels_from_attribute(const Cloud& cloud, const Attribute& attribute,
                                            const Returns& returns);
/// Rows of an organised cloud, or its columns if `transposed`; nothing if there are too many.
std::optional<Labels> labels_from_rows(const Cloud& cloud, const Returns& returns, bool transposed);

/// The widest part of the circle without returns, counter-clockwise up to `end`.
struct EmptyArc {
  double end = 0, width = 0;  ///< radians
};
EmptyArc widest_empty_arc(const Returns& returns);

/// Azimuths at which the turns of a file may start, the likeliest first.
std::vector<double> guess_turn_starts(const Returns& returns, const EmptyArc& empty);

/// Turns of the azimuth in file order, each from azimuth `start`; nothing for files in another
/// order. O(n).
std::optional<Labels> labels_from_turns(const Returns& returns, double start,
                                        const EmptyArc& empty);

}  // namespace curlidar
