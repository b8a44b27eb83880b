// SPDX-License-Identifier: BSD-3-Clause
#include "paper/upsample.hpp"

#include <algorithm>

#include "paper/raycast.hpp"

namespace curlidar {

CellPosition SampleImage::position(std::size_t row, std::size_t column) const {
  const auto fine_row = static_cast<std::int64_t>(row) - (row_factor - 1);
  const std::int64_t whole = fine_row >= 0 ? fine_row / row_factor : -1;
  CellPosition p;
  p.row = whole;
  p.row_fraction = static_cast<double>(fine_row - whole * row_factor) / row_factor;
  p.column = static_cast<std::int64_t>(column / column_factor);
  p.column_fraction = static_cast<double>(column % column_factor) / column_factor;
  return p;
}

std::size_t SampleImage::count() const {
  return static_cast<std::size_t>(
      std::count_if(range.begin(), range.end(), [](double r) { return r > 0; }));
}

SampleImage original_samples(const RangeImage& image) {
  return {1, 1, image.lattice.rows(), image.lattice.columns(), image.range};
}

SampleImage upsample(const RangeImage& image, const PolarMesh& mesh, const CellMasks& masks,
                     std::uint32_t row_factor, std::uint32_t column_factor, double refused_share,
                     std::size_t threads) {
  if (row_factor == 1 && column_factor == 1) return original_samples(image);
  SampleImage out{row_factor,
                  column_factor,
                  image.lattice.rows() * row_factor,
                  image.lattice.columns() * column_factor,
                  {}};
  const std::size_t cells = static_cast<std::size_t>(out.rows) * out.columns;
  out.range.assign(cells, 0);
  std::vector<std::uint8_t> wanted(cells, 0);
  for (std::size_t i = 0; i < out.rows; ++i) {
    for (std::size_t j = 0; j < out.columns; ++j) {
      const CellPosition p = out.position(i, j);
      if (!believed(masks, p)) continue;
      if (p.row_fraction == 0 && p.column_fraction == 0) {
        out.range[out.index(i, j)] = image.range[masks.index(p.row, p.column)];
      } else {
        wanted[out.index(i, j)] = 1;
      }
    }
  }
  const DenseGrid grid(image.lattice, row_factor, column_factor);
  const RayHits hits = cast_rays(mesh, image.lattice, grid, wanted, threads);
  const std::vector<std::uint8_t> refused = largest_triangles(mesh, refused_share);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    if (hits.triangle[cell] != kNoTwin && !refused[hits.triangle[cell]]) {
      out.range[cell] = hits.range[cell];
    }
  }
  return out;
}

}  // namespace curlidar
