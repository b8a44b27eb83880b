// SPDX-License-Identifier: BSD-3-Clause
// Cubes and planes of a tile, in integers: lengths in ticks of 1/4096 m, slopes in Q16, curvatures
// in Q16 a metre.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace curlidar::tile {

inline constexpr std::int32_t kTicks = 4096;  ///< a metre
inline constexpr std::int32_t kMaxSlope = 2 << 16;
inline constexpr std::int32_t kMaxCurve = 1 << 20;
inline constexpr std::int32_t kMaxHeight = 1 << 30;
inline constexpr std::uint32_t kMaxLevels = 5;  ///< below the roots
/// What each doubling of a leaf multiplies its step by, in 1/16, unless the header says otherwise.
inline constexpr std::uint32_t kStepFall = 9;
/// A cell is told about only where its plane comes as near as this to the cube, ticks.
inline constexpr std::int32_t kCellSlack = 256;

using Ticks3 = std::array<std::int32_t, 3>;

/// What a tile's header says.
struct TileLayout {
  std::uint32_t root_log2 = 14;  ///< edge of a root, log2 of ticks
  std::uint32_t levels = 4;      ///< of splits below a root
  std::uint32_t cells_log2 = 4;  ///< footprint cells along a root's edge, log2
  std::uint32_t side_roots = 8;  ///< roots along the tile's side
  std::int32_t step = 819;       ///< of heights in leaves of half a metre and smaller, ticks
  std::uint32_t fall = 16;       ///< each doubling of a leaf multiplies its step by this / 16
  std::int32_t first_row = 0;    ///< of roots, in roots above z = 0
  std::uint32_t rows = 0;
  bool curves = false;
  bool intensity = false;
  float intensity_step = 1;

  std::int32_t edge(std::uint32_t level) const { return std::int32_t{1} << (root_log2 - level); }
  /// Footprint cells along a leaf's edge.
  std::uint32_t cells(std::uint32_t level) const {
    return level >= cells_log2 ? 1 : 1u << (cells_log2 - level);
  }
  /// Finest cubes along a cube's edge.
  std::uint32_t fine(std::uint32_t level) const { return 1u << (levels - level); }
  std::uint32_t fine_log2() const { return root_log2 - levels; }

  /// Steps of a leaf's height (ticks) and slope (Q16), curvature (Q16 a metre).
  std::int32_t height_step(std::uint32_t level) const {
    std::int32_t out = step;
    for (std::uint32_t log2 = root_log2 - level; log2 > 11; --log2) {
      out = static_cast<std::int32_t>(std::int64_t{out} * fall / 16);
    }
    return std::max(out, 1);
  }
  std::int32_t slope_step(std::uint32_t level) const {
    const std::int64_t rise = (std::int64_t{height_step(level)} << 17) / edge(level);
    return static_cast<std::int32_t>(std::max<std::int64_t>(rise, 1));
  }
  std::int32_t curve_step(std::uint32_t level) const {
    const std::int64_t s = edge(level);
    const std::int64_t rise = (std::int64_t{height_step(level)} << 30) / (s * s);
    return static_cast<std::int32_t>(std::max<std::int64_t>(rise, 1));
  }
};

/// A cube of the octree: its place in cubes of its level from the tile's corner (z from the lowest
/// row).
struct TileCube {
  std::uint32_t level = 0;
  std::array<std::uint32_t, 3> at{};

  TileCube child(std::uint32_t k) const {
    return {level + 1, {2 * at[0] + (k & 1), 2 * at[1] + (k >> 1 & 1), 2 * at[2] + (k >> 2)}};
  }
};

/// Centre of a cube, ticks from the tile's origin.
inline Ticks3 centre_of(const TileLayout& layout, const TileCube& cube) {
  const std::int32_t edge = layout.edge(cube.level);
  Ticks3 centre{};
  for (std::size_t k = 0; k < 3; ++k) {
    centre[k] = static_cast<std::int32_t>(cube.at[k]) * edge + edge / 2;
  }
  centre[2] += layout.first_row * layout.edge(0);
  return centre;
}

/// One coordinate as a linear function of the two others, u = axis + 1 and v = axis + 2 modulo 3.
struct TilePlane {
  std::uint32_t axis = 2;
  std::int32_t u = 0, v = 0;  ///< where the height is
  std::int32_t height = 0;
  std::array<std::int32_t, 2> slope{};

  std::int32_t at(std::int32_t pu, std::int32_t pv) const {
    const std::int64_t rise = std::int64_t{slope[0]} * (pu - u) + std::int64_t{slope[1]} * (pv - v);
    const std::int64_t found = height + ((rise + 32768) >> 16);
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(found, -kMaxHeight, kMaxHeight));
  }
};

inline std::uint32_t u_axis(std::uint32_t axis) {
  return axis == 2 ? 0 : axis + 1;
}
inline std::uint32_t v_axis(std::uint32_t axis) {
  return axis == 0 ? 2 : axis - 1;
}

}  // namespace curlidar::tile
