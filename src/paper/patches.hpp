// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-C1: the partition of the upsampled depth image into patches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/lattice.hpp"
#include "field/patch_basis.hpp"

namespace curlidar {

/// What a cell of a patch's window is used for.
enum class CellRole : std::uint8_t {
  training,  ///< fitted
  testing,   ///< held out to judge the degree: the X of both diagonals on every second row
  extended,  ///< around the patch, shared with the neighbours, fitted
};

/// A rectangle of dense cells; columns may leave [0, columns) and then wrap.
struct CellRect {
  std::int64_t row_begin = 0, row_end = 0, column_begin = 0, column_end = 0;

  std::size_t height() const { return static_cast<std::size_t>(row_end - row_begin); }
  std::size_t width() const { return static_cast<std::size_t>(column_end - column_begin); }
  std::size_t cells() const { return height() * width(); }
};

/// The grid of patches over a lattice. Every dense cell belongs to one patch; the
/// last patches of a row or column are smaller when the sizes do not divide.
class PatchGrid {
 public:
  PatchGrid(const Lattice& lattice, std::uint32_t row_factor, std::uint32_t column_factor,
            std::uint32_t patch, std::uint32_t overlap);

  std::size_t rows() const { return patch_rows_; }
  std::size_t columns() const { return patch_columns_; }
  std::size_t count() const { return patch_rows_ * patch_columns_; }

  /// The patch's own dense cells, and the window with its extended cells: rows are cut off at the
  /// image, columns wrap but never cover a cell twice.
  CellRect core(std::size_t patch_row, std::size_t patch_column) const;
  CellRect window(std::size_t patch_row, std::size_t patch_column) const;
  /// Role of every cell of the window, row-major.
  std::vector<CellRole> roles(std::size_t patch_row, std::size_t patch_column) const;

  /// The patch that answers for a fractional lattice position: the one of the nearest dense cell.
  std::size_t patch_row_at(double row) const;
  std::size_t patch_column_at(double column) const;

  /// The basis over the nominal cells of a patch; depends on the row and the window's width only.
  PatchBasis make_basis(std::size_t patch_row, std::size_t patch_column) const;
  /// Tangent frame of a patch, relative to its centre azimuth.
  LocalFrame frame(std::size_t patch_row) const { return LocalFrame(centre_elevation(patch_row)); }
  double centre_azimuth(std::size_t patch_column) const;

  /// What making the basis of every row of patches may take: rows * cells * functions^2.
  std::uint64_t basis_work() const;

  std::uint32_t dense_rows() const { return dense_rows_; }
  std::uint32_t dense_columns() const { return dense_columns_; }

 private:
  double centre_elevation(std::size_t patch_row) const;
  /// Lattice row of a (fractional) dense row.
  double lattice_row(double dense_row) const;

  Lattice lattice_;
  std::uint32_t row_factor_, column_factor_, patch_, overlap_;
  std::uint32_t dense_rows_, dense_columns_;
  std::size_t patch_rows_, patch_columns_;
};

}  // namespace curlidar
