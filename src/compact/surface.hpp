// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of the compact field: inverse range as a function of direction, on the span of spherical
// harmonics up to degree 2 restricted to a patch,
//   1 / r (d) = n . d + a3 B3(d) + a4 B4(d) + a5 B5(d),
// with B0..B2 (parts of n . d) and B3..B5 orthonormal over the patch's cells. A plane in space is
// exactly n . d. All integers; docs/format says the same to the bit.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "compact/geometry.hpp"

namespace curlidar::compact {

/// Cells row .. row + height - 1, column .. column + width - 1 of a segment.
struct Block {
  std::uint32_t row = 0, column = 0, height = 0, width = 0;
  std::uint32_t cells() const { return height * width; }
};

/// Functions kept in a surface: none, the constant, the plane, all of degree 2.
inline constexpr std::array<std::uint32_t, 4> kFunctions = {0, 1, 3, 6};
inline constexpr std::uint32_t kMaxFunctions = 6;

/// Scales of the orthonormal functions of all patches with the same rows and size; shared along a
/// row of the lattice, because the span rotates into itself.
struct PatchShape {
  SinCos elevation;          ///< of the patch's middle
  std::int64_t norm = 0;     ///< 1 / sqrt(cells), Q30
  std::int64_t scale_u = 0;  ///< 1 / rms of u over the cells, Q14; 0 where they do not spread
  std::int64_t scale_v = 0;
  std::int64_t skew_v = 0;                ///< mean of the cube of v / rms, Q20
  std::int64_t norm_uu = 0, norm_vv = 0;  ///< 1 / norms of the quadratic functions, Q30
};

PatchShape make_shape(const Geometry& geometry, const Block& block);

/// The frame of one patch: its shape turned to its azimuth.
struct PatchFrame {
  PatchShape shape;
  Axis c, u, v;  ///< middle direction, along the row, up

  PatchFrame(const Geometry& geometry, const PatchShape& shape, const Block& block);

  /// B3, B4, B5 in a direction, Q20.
  std::array<std::int64_t, 3> quadratic(const Direction& d) const;
};

/// What neighbours inherit: n in Q30 (1/m).
struct Plane {
  std::int64_t x = 0, y = 0, z = 0;

  /// n . d in Q30.
  std::int64_t at(const Direction& d) const { return (x * d.x + y * d.y + z * d.z) >> 22; }
  /// n . o in Q30, for |n| up to 2^38 and |o| up to 2^22 an axis.
  std::int64_t beside(const Origin& o) const { return (x * o.x + y * o.y + z * o.z) >> 16; }
};

/// The plane square to the patch's middle at a range.
Plane facing_plane(const PatchFrame& frame, std::int64_t range);

/// The range `share` (Q30; taken within [1/4, 4]) of 1 / inverse (Q30), within [kMinRange,
/// kMaxRange].
inline std::int64_t range_of(std::int64_t inverse, std::int64_t share = std::int64_t{1} << 30) {
  constexpr std::int64_t low = (std::int64_t{1} << 46) / kMaxRange;
  constexpr std::int64_t high = (std::int64_t{1} << 46) / kMinRange;
  inverse = std::clamp(inverse, low, high);
  share = std::clamp(share, std::int64_t{1} << 28, std::int64_t{1} << 32);
  return std::clamp((share << 16) / inverse, kMinRange, kMaxRange);
}

struct Surface {
  Plane plane;
  std::array<std::int64_t, 3> quadratic{};  ///< a3..a5, Q30
  bool curved = false;
  /// In each cell the plane is that of the cell's guide plus `added`; `plane` is what it is where
  /// there is none, and what neighbours inherit.
  bool warped = false;
  Plane added{};

  std::int64_t inverse_at(const PatchFrame& frame, const Direction& d) const {
    std::int64_t inverse = plane.at(d);
    if (curved) {
      const std::array<std::int64_t, 3> b = frame.quadratic(d);
      inverse += (quadratic[0] * b[0] + quadratic[1] * b[1] + quadratic[2] * b[2]) >> 20;
    }
    return inverse;
  }
  /// Range in a direction, Q16 metres.
  std::int64_t range_at(const PatchFrame& frame, const Direction& d) const {
    return range_of(inverse_at(frame, d));
  }
  /// Range along a line of sight. A plane n . p = 1 meets o + r d at r = (1 - n . o) / (n . d).
  std::int64_t range_at(const PatchFrame& frame, const Sight& sight) const {
    constexpr std::int64_t one = std::int64_t{1} << 30;
    return range_of(inverse_at(frame, sight.direction), one - plane.beside(sight.origin));
  }
};

/// A warped surface over the plane that the guide has in a cell.
Surface on_plane_of(const Surface& warped, const Plane& plane);

/// Coefficients in steps, one for each function.
using Quantised = std::array<std::int32_t, kMaxFunctions>;
/// Larger coefficients do not exist.
inline constexpr std::int32_t kMaxQuantised = 1 << 20;

/// The step of the coefficients of a patch whose middle is seen at inverse range `inverse` (Q30):
/// D / r^2, in Q40.
std::int64_t coefficient_step(std::int64_t inverse, std::int32_t step);

/// `base` plus the first `functions` functions times q * step.
Surface add_functions(const Plane& base, const PatchFrame& frame, std::int64_t step_q40,
                      const Quantised& q, std::uint32_t functions);

}  // namespace curlidar::compact
