// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-B: the upsampled and denoised depth image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/lattice.hpp"
#include "image/range_image.hpp"
#include "paper/masks.hpp"
#include "paper/polar_mesh.hpp"

namespace curlidar {

/// Ranges on a grid S_row x S_col times denser than the lattice.
struct SampleImage {
  std::uint32_t row_factor = 1, column_factor = 1;
  std::uint32_t rows = 0, columns = 0;  ///< of the dense grid
  std::vector<double> range;            ///< metres, 0 where there is no sample

  std::size_t index(std::size_t row, std::size_t column) const { return row * columns + column; }
  /// Position of a dense cell on the lattice: rows factor - 1, 2 factor - 1, ... and columns 0,
  /// factor, ... are original cells.
  CellPosition position(std::size_t row, std::size_t column) const;
  std::size_t count() const;
};

/// The original returns on a factor 1 grid.
SampleImage original_samples(const RangeImage& image);

/// Cells on original cells copy their return. The others are rays into the mesh; hits on the
/// largest `refused_share` of the triangles and cells that the masks do not believe stay empty.
/// (Where the top row lies below the horizon the mesh does not enclose the sensor: rays along that
/// row, which pass above the chords between its returns, meet nothing.)
SampleImage upsample(const RangeImage& image, const PolarMesh& mesh, const CellMasks& masks,
                     std::uint32_t row_factor, std::uint32_t column_factor, double refused_share,
                     std::size_t threads);

}  // namespace curlidar
