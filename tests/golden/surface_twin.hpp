// SPDX-License-Identifier: BSD-3-Clause
// The twin of a tile of a surface map: a line for each leaf, in whole numbers.
#pragma once

#include <cmath>
#include <string>

#include "curlidar/map_tile.hpp"

namespace curlidar::test {

/// Level, centre, axis, height (1/4096 m), slopes, curvatures (1/65536), intensity (1/65536, 0
/// where there is none), footprint.
inline std::string surface_twin(const MapTile& tile) {
  std::string text;
  const auto add = [&](double value) {
    text += std::to_string(std::llround(value));
    text += ' ';
  };
  for (const MapLeaf& leaf : tile.leaves) {
    add(leaf.level);
    for (const double c : {leaf.centre.x, leaf.centre.y, leaf.centre.z}) add(c * 4096);
    add(leaf.axis);
    add(leaf.height_m * 4096);
    for (const double slope : leaf.slope) add(slope * 65536);
    for (const double curve : leaf.curve) add(curve * 65536);
    add(std::isfinite(leaf.intensity) ? static_cast<double>(leaf.intensity) * 65536 : 0);
    for (std::size_t k = 0; k < std::size_t{leaf.cells} * leaf.cells; ++k) {
      text += tile.footprint[leaf.first_cell + k] != 0 ? '1' : '0';
    }
    text += '\n';
  }
  return text;
}

}  // namespace curlidar::test
