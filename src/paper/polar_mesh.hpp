// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-A: the mesh of a scan, triangulated in the plane of (ring number, azimuth).
#pragma once

#include <cstdint>
#include <vector>

#include "curlidar/vec3.hpp"
#include "image/range_image.hpp"
#include "paper/delaunay.hpp"

namespace curlidar {

struct PolarMesh {
  std::vector<Vec3> vertices;        ///< points at cell centres
  std::vector<std::uint32_t> cells;  ///< cell of the range image of each vertex
  Triangulation surface;             ///< Delaunay in the polar plane, corners into vertices
  std::vector<std::uint32_t> cap;    ///< three corners a triangle: the convex closure

  std::size_t triangles() const { return surface.triangles() + cap.size() / 3; }
  /// Corner k of triangle t; the triangles of the cap follow those of the surface.
  std::uint32_t corner(std::size_t t, std::size_t k) const {
    const std::size_t i = 3 * t + k;
    return i < surface.corner.size() ? surface.corner[i] : cap[i - surface.corner.size()];
  }
};

/// Vertices at radius n = row + 1 (top beam innermost) and the azimuth of their column.
/// Points on concentric rings come in cocircular groups, which Delaunay leaves open: edges between
/// two triangles of such a group are flipped until each is the shorter diagonal in space (then the
/// one with the smaller vertex number), so that edges rather stay on a surface than cross from one
/// to another.
/// The hull of the plane is triangulated again as the bottom cap, wound the other way, so that
/// surface and cap together are closed. Fewer than three points give no triangles.
PolarMesh make_polar_mesh(const RangeImage& image);

/// Position of a cell in the polar plane, scaled to exact integers.
GridPoint polar_grid_point(const Lattice& lattice, std::size_t row, std::size_t column);

}  // namespace curlidar
