// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-B1: rays of a virtual LiDAR into the mesh. All rays leave from the origin, so that a
// ray meets a triangle where its direction falls into the triangle's cone: triangles are drawn
// into the grid of rays as a rasteriser does, and no general ray tracer is needed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/lattice.hpp"
#include "paper/polar_mesh.hpp"

namespace curlidar {

/// A dense grid of rays over a lattice; rays[i * columns + j] looks along (row(i), column(j)).
struct RayHits {
  std::vector<double> range;            ///< metres to the nearest triangle; 0 where none is met
  std::vector<std::uint32_t> triangle;  ///< its number, kNoTwin where none is met
};

/// Casts the rays for which wanted[i * columns + j] is not 0. A ray on an edge, as far
/// as doubles can tell, meets both of its triangles, so that none is lost to rounding; triangles
/// seen edge-on are left to their neighbours. Of equally near triangles the lowest number wins.
/// Cost: the sum of the triangles' bounding boxes on the grid. Same result for any thread count.
RayHits cast_rays(const PolarMesh& mesh, const Lattice& lattice, const DenseGrid& grid,
                  const std::vector<std::uint8_t>& wanted, std::size_t threads);

/// Marks the `share` of triangles with the largest area in space; refused[t] is 0 or 1.
std::vector<std::uint8_t> largest_triangles(const PolarMesh& mesh, double share);

}  // namespace curlidar
