// SPDX-License-Identifier: BSD-3-Clause
// The paper's stages before fitting, for people who want the mesh or the upsampled cloud itself.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// Triangles in space; corners in counter-clockwise order seen in the polar plane (n, phi).
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The polar Delaunay mesh of a scan with its convex closure: a closed surface (paper, III-A).
Result<Mesh> polar_mesh(const Cloud& cloud, const EncodeSettings& settings = {});

/// The upsampled and denoised scan (paper, III-B) on its rows x columns grid.
struct Upsampled {
  Cloud cloud;  ///< organised rows x columns, NaN where there is no sample; float32
  std::uint32_t rows = 0, columns = 0;
  std::uint32_t mask_rows = 0, mask_columns = 0;  ///< size of the original grid and of the masks
  /// Masks on the original grid, 0 or 1 a cell: a return; a cliff towards the previous row, the
  /// previous column, the previous cell on the diagonal.
  std::vector<std::uint8_t> point_grid, cliff_row, cliff_column, cliff_diagonal;
  ProjectionCounts projection;
};
Result<Upsampled> upsample_scan(const Cloud& cloud, const EncodeSettings& settings = {});

}  // namespace curlidar
