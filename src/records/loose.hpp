// SPDX-License-Identifier: BSD-3-Clause
// Chunk `loose`: points that are in no cell of an image, or a whole cloud, in their own order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "format/container.hpp"

namespace curlidar {

/// How exactly points come back. Both zero: bit for bit.
struct LooseSettings {
  double max_error_m = 0;  ///< no decoded point lies farther than this from its own, in 3D
  double step_m = 0;  ///< instead: coordinates to the nearest multiple of this, no bound checked
};

/// A chunk's payload and what its decoder makes of it.
struct CodedPoints {
  std::vector<std::byte> bytes;
  std::vector<Vec3> decoded;  ///< in the type's precision
};

/// Codes points in the order given. `type` is float32 or float64, and all coordinates, those
/// decoded too, are finite values of it: max_error_m holds after rounding (checked point by point).
/// Only the origin is decoded to the origin. Errors: invalid_argument (other coordinates, another
/// type, settings that are negative or not finite). O(n), some 10 us a point.
Result<CodedPoints> encode_loose(std::span<const Vec3> points, ScalarType type,
                                 const LooseSettings& settings);

/// Reads what encode_loose wrote. Errors: corrupt, limit_exceeded (more than `max_points`).
/// Allocates for points that the payload has bytes for.
Result<std::vector<Vec3>> decode_loose(const Chunk& chunk, std::size_t max_points);

/// An order in which points that follow each other lie close together: along the Morton curve of
/// the bounding box, 2^21 cells a side. For clouds in no order at all: the order in which a sensor
/// saw its points codes in far fewer bits. O(n log n).
std::vector<std::uint32_t> morton_order(std::span<const Vec3> points);

}  // namespace curlidar
