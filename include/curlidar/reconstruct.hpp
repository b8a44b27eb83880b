// SPDX-License-Identifier: BSD-3-Clause
// Clouds from a decoded scan, at any density.
#pragma once

#include <cstddef>
#include <cstdint>

#include "curlidar/cloud.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

struct ReconstructSettings {
  double rows = 1;         ///< R_row: factor on the coded lattice's rows, may be fractional, > 0
  double columns = 1;      ///< R_col
  bool masks = true;       ///< apply point grid and cliffs; off gives every cell a point
  bool organised = false;  ///< keep empty cells as NaN
  std::size_t threads = 1;
  std::uint64_t max_points = 1ull << 31;  ///< refuse larger grids
};

/// The cloud seen on an R_row x R_col times denser grid. With factors 1 x 1 and masks: the coded
/// returns one for one with their attributes, or the encoded cloud of files with every return;
/// otherwise attributes of the nearest coded return. Compact files cut off or decoded in part give
/// what is there.
Result<Cloud> reconstruct(const DecodedScan& scan, const ReconstructSettings& settings = {});

}  // namespace curlidar
