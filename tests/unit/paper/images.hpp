// SPDX-License-Identifier: BSD-3-Clause
// Hand-made depth images.
#pragma once

#include <cstddef>
#include <numbers>

#include "image/range_image.hpp"
#include "support/clouds.hpp"

namespace curlidar::test {

inline constexpr double kDegree = std::numbers::pi / 180;

/// In [0, 1).
inline double unit(Random& random) {
  return static_cast<double>(random.next() >> 11) * 0x1p-53;
}

/// range_of(row, column) in metres, 0 for an empty cell. Sources are numbered as cells are.
template <class RangeOf>
RangeImage make_image(const Lattice& lattice, const RangeOf& range_of) {
  RangeImage image{lattice, std::vector<double>(lattice.cells(), 0.0),
                   std::vector<std::uint32_t>(lattice.cells(), kNoPoint)};
  for (std::size_t row = 0; row < lattice.rows(); ++row) {
    for (std::size_t column = 0; column < lattice.columns(); ++column) {
      const double range = range_of(row, column);
      if (range <= 0) continue;
      const std::size_t cell = image.index(row, column);
      image.range[cell] = range;
      image.source[cell] = static_cast<std::uint32_t>(cell);
    }
  }
  return image;
}

/// Ranges between 5 and 20 m; each cell is occupied with the given probability.
inline RangeImage random_image(const Lattice& lattice, double occupied, Random& random) {
  return make_image(lattice, [&](std::size_t, std::size_t) {
    const bool here = unit(random) < occupied;
    const double range = 5 + 15 * unit(random);
    return here ? range : 0.0;
  });
}

/// Rows from +10 to -25 degrees.
inline Lattice small_lattice(std::uint32_t rows, std::uint32_t columns) {
  return Lattice::uniform(rows, columns, 10 * kDegree, -25 * kDegree);
}

}  // namespace curlidar::test
