// SPDX-License-Identifier: BSD-3-Clause
// How surface maps are made, and what they are made from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "curlidar/vec3.hpp"

namespace curlidar {

/// A point of the surface as measured.
struct MapSample {
  Vec3 position{};   ///< from the tile's origin, metres
  float weight = 1;  ///< how much its distance from the map counts
  float intensity = std::numeric_limits<float>::quiet_NaN();  ///< NaN: unknown
};

/// How a surface map trades bytes for accuracy. Sizes are powers of two of a metre.
struct SurfaceSettings {
  /// Planes are rounded so that their corners move by about half of this at most in leaves of half
  /// a metre; larger leaves are rounded finer.
  double step_m = 0.1;
  /// A bit is spent where it brings samples of weight 1 nearer to the map by this much in all.
  double metres_per_bit = 0.15;
  double root_m = 4;              ///< edge of the octree's largest cubes
  double smallest_leaf_m = 0.25;  ///< edge of its smallest
  double footprint_m = 0.25;      ///< edge of the cells that tell where surface was seen
  double drop_m = 0.3;            ///< a sample farther from the map than this counts as this far
  bool curves = false;            ///< leaves may be of second order
  bool intensity = false;         ///< a mean intensity for each leaf
  /// Surface where nothing was measured counts as so many left-out samples a square metre: more
  /// keeps footprints to what was seen, less lets them close gaps where that saves bits.
  double bare_samples = 60;
  /// The samples of one smallest cube weigh no more than this in all: what is seen again and again
  /// must not become dearer.
  double full_weight = 25;
  double intensity_step = 1.0 / 32;  ///< what intensities are rounded to
};

/// What decoding a tile may take at most.
struct TileLimits {
  std::size_t max_leaves = std::size_t{1} << 20;
  std::size_t max_cells = std::size_t{1} << 24;  ///< of all footprints
};

}  // namespace curlidar
