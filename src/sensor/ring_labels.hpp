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

/// Where the turns of a file may start, and how much of the circle they cover.
struct TurnStart {
  double azimuth = 0, extent = 0;  ///< radians
};
std::vector<TurnStart> guess_turn_starts(const Returns& returns);

/// Turns of the azimuth in file order; nothing for files in another order. O(n).
std::optional<Labels> labels_from_turns(const Returns& returns, const TurnStart& start);

}  // namespace curlidar
