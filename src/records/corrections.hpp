// SPDX-License-Identifier: BSD-3-Clause
// Chunk `corrections`: brings predicted points within a bound of the originals, or back bit for
// bit.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "format/container.hpp"

namespace curlidar {

struct CorrectionSettings {
  double max_error_m = 0;  ///< 3D, of every single point; 0: bit for bit
};

struct CodedCorrections {
  std::vector<std::byte> bytes;
  std::vector<Vec3> decoded;  ///< what apply_corrections makes of the predicted points
  std::size_t corrected = 0;  ///< points that differ from their prediction; 0: no need for a chunk
};

/// `predicted` and `original` are as long as each other, finite, and values of `type` (float32 or
/// float64); predicted points must be the same doubles on every machine. The bound is checked point
/// by point. Errors: invalid_argument for anything else. O(n).
Result<CodedCorrections> encode_corrections(std::span<const Vec3> predicted,
                                            std::span<const Vec3> original, ScalarType type,
                                            const CorrectionSettings& settings);

/// Turns predicted points into the decoded ones, values of `type`. Errors: corrupt (also for
/// another number of points or another type than was encoded), after which the points are of no
/// use. O(n), allocates O(1) memory.
Status apply_corrections(const Chunk& chunk, ScalarType type, std::span<Vec3> points);

}  // namespace curlidar
