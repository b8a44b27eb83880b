// SPDX-License-Identifier: BSD-3-Clause
// Delaunay triangulation of points with integer coordinates, exact whatever their arrangement.
#pragma once

#include <cstdint>
#include <vector>

namespace curlidar {

struct GridPoint {
  std::int32_t x = 0, y = 0;
  friend auto operator<=>(const GridPoint&, const GridPoint&) = default;
};

/// Coordinates must lie within +-kMaxCoordinate, so that the predicates never overflow.
inline constexpr std::int32_t kMaxCoordinate = 1 << 26;

inline constexpr std::uint32_t kNoTwin = 0xffffffffu;

/// Triangle t has the corners corner[3t..3t+2], counter-clockwise. Half-edge h of triangle h / 3
/// runs from corner[h] to the next corner; twin[h] is the half-edge of the neighbouring triangle
/// along the same edge, kNoTwin on the hull.
struct Triangulation {
  std::vector<std::uint32_t> corner;
  std::vector<std::uint32_t> twin;

  std::size_t triangles() const { return corner.size() / 3; }
};

inline std::uint32_t next_half_edge(std::uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
inline std::uint32_t previous_half_edge(std::uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

/// Sign of twice the signed area of abc: positive if counter-clockwise. Exact.
int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c);
/// Positive if d lies inside the circle through a, b, c (counter-clockwise), 0 if on it. Exact.
int in_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d);

/// Triangulates distinct points; fewer than three points, or all on one line, give no triangles.
/// Divide and conquer over quad-edges (Guibas and Stolfi 1985), O(n log n).
Triangulation delaunay(const std::vector<GridPoint>& points);

}  // namespace curlidar
