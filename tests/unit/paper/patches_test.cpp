// SPDX-License-Identifier: BSD-3-Clause
#include "paper/patches.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "unit/paper/images.hpp"

namespace curlidar {
namespace {

using test::small_lattice;

/// One character a cell: t(raining), T(esting), e(xtended).
std::string drawn(const PatchGrid& grid, std::size_t row, std::size_t column) {
  const CellRect window = grid.window(row, column);
  std::string out;
  std::size_t cell = 0;
  for (const CellRole role : grid.roles(row, column)) {
    out += role == CellRole::extended ? 'e' : role == CellRole::testing ? 'T' : '.';
    if (++cell % window.width() == 0) out += '\n';
  }
  return out;
}

TEST(PatchGrid, RolesOfThePapersPatch) {
  const PatchGrid grid(small_lattice(64, 1024), 2, 2, 4, 2);
  EXPECT_EQ(grid.rows(), 16u);
  EXPECT_EQ(grid.columns(), 256u);
  EXPECT_EQ(drawn(grid, 3, 5),
            "eeeeeeeeeeee\n"
            "eeeeeeeeeeee\n"
            "eeT......Tee\n"
            "ee........ee\n"
            "ee..T..T..ee\n"
            "ee........ee\n"
            "ee...TT...ee\n"
            "ee........ee\n"
            "ee.T....T.ee\n"
            "ee........ee\n"
            "eeeeeeeeeeee\n"
            "eeeeeeeeeeee\n");
}

TEST(PatchGrid, WindowsWrapInAzimuthAndAreCutInElevation) {
  const PatchGrid grid(small_lattice(64, 1024), 2, 2, 4, 2);
  const CellRect top = grid.window(0, 0);
  EXPECT_EQ(top.row_begin, 0);
  EXPECT_EQ(top.row_end, 10);
  EXPECT_EQ(top.column_begin, -2);
  EXPECT_EQ(top.column_end, 10);
  const CellRect bottom = grid.window(15, 255);
  EXPECT_EQ(bottom.row_begin, 118);
  EXPECT_EQ(bottom.row_end, 128);
  EXPECT_EQ(bottom.column_begin, 2038);
  EXPECT_EQ(bottom.column_end, 2050);
  EXPECT_EQ(drawn(grid, 0, 0).substr(0, 13), "eeT......Tee\n");
  EXPECT_EQ(drawn(grid, 15, 255).substr(9 * 13), "ee........ee\n");
}

TEST(PatchGrid, NoCellOfAWindowIsMetTwice) {
  for (const std::uint32_t columns : {4u, 5u, 7u, 9u, 16u}) {
    const PatchGrid grid(small_lattice(8, columns), 2, 1, 4, 6);
    for (std::size_t patch = 0; patch < grid.columns(); ++patch) {
      const CellRect own = grid.core(0, patch), all = grid.window(0, patch);
      EXPECT_LE(all.width(), columns);
      EXPECT_LE(all.column_begin, own.column_begin);
      EXPECT_GE(all.column_end, own.column_end);
      // The frame of the patch is about the middle of both.
      EXPECT_EQ(own.column_begin - all.column_begin, all.column_end - own.column_end);
    }
  }
}

TEST(PatchGrid, CoresPartitionTheDenseGrid) {
  struct Sizes {
    std::uint32_t rows, columns, row_factor, column_factor, patch;
  };
  for (const Sizes& s : {Sizes{64, 64, 2, 2, 4},
                         {10, 30, 2, 3, 4},
                         {1, 7, 1, 1, 4},
                         {5, 9, 4, 1, 2},
                         {3, 4, 2, 2, 64},
                         {13, 17, 1, 1, 5}}) {
    const PatchGrid grid(small_lattice(s.rows, s.columns), s.row_factor, s.column_factor, s.patch,
                         2);
    EXPECT_EQ(grid.count(), grid.rows() * grid.columns());
    std::vector<int> owners(std::size_t{grid.dense_rows()} * grid.dense_columns(), 0);
    for (std::size_t row = 0; row < grid.rows(); ++row) {
      for (std::size_t column = 0; column < grid.columns(); ++column) {
        const CellRect core = grid.core(row, column);
        ASSERT_GT(core.cells(), 0u);
        ASSERT_EQ(grid.roles(row, column).size(), grid.window(row, column).cells());
        for (std::int64_t i = core.row_begin; i < core.row_end; ++i) {
          for (std::int64_t j = core.column_begin; j < core.column_end; ++j) {
            ++owners[static_cast<std::size_t>(i * grid.dense_columns() + j)];
            // Each dense cell is answered for by the patch it belongs to.
            const double lattice_row = (static_cast<double>(i) - (s.row_factor - 1)) / s.row_factor;
            const double lattice_column = static_cast<double>(j) / s.column_factor;
            ASSERT_EQ(grid.patch_row_at(lattice_row), row);
            ASSERT_EQ(grid.patch_column_at(lattice_column), column);
            ASSERT_EQ(grid.patch_column_at(lattice_column - s.columns), column);
            ASSERT_EQ(grid.patch_column_at(lattice_column + 2.0 * s.columns), column);
          }
        }
      }
    }
    for (const int owner : owners) ASSERT_EQ(owner, 1);
  }
}

TEST(PatchGrid, PositionsOutsideTheRowsBelongToTheOutermostPatches) {
  const PatchGrid grid(small_lattice(16, 32), 2, 2, 4, 2);
  EXPECT_EQ(grid.patch_row_at(-100), 0u);
  EXPECT_EQ(grid.patch_row_at(100), 3u);
  // Between cells the nearest dense one decides.
  EXPECT_EQ(grid.patch_column_at(3.74), 0u);
  EXPECT_EQ(grid.patch_column_at(3.76), 1u);
  EXPECT_EQ(grid.patch_column_at(-0.24), 0u);
  EXPECT_EQ(grid.patch_column_at(-0.26), 7u);
  EXPECT_EQ(grid.patch_row_at(3.24), 0u);
  EXPECT_EQ(grid.patch_row_at(3.26), 1u);
}

TEST(PatchGrid, BasisIsOverTheWindowsDirections) {
  const Lattice lattice = small_lattice(10, 60);
  const PatchGrid grid(lattice, 2, 2, 4, 2);
  for (const auto& [row, column] : {std::pair<std::size_t, std::size_t>{0, 0}, {1, 14}, {2, 7}}) {
    const CellRect window = grid.window(row, column);
    PatchBasis basis = grid.make_basis(row, column);
    ASSERT_EQ(basis.cells(), window.cells());
    // A polynomial of the basis, evaluated where each cell looks, gives the basis' values.
    std::vector<double> coefficients(basis.functions(0) + 2, 0.5);
    basis.extend(1);
    const std::vector<double> local = basis.to_local(coefficients, 1);
    std::size_t cell = 0;
    for (std::int64_t i = window.row_begin; i < window.row_end; ++i) {
      for (std::int64_t j = window.column_begin; j < window.column_end; ++j, ++cell) {
        const double elevation = lattice.elevation((static_cast<double>(i) - 1) / 2);
        const double azimuth = std::remainder(
            lattice.azimuth(static_cast<double>(j) / 2) - grid.centre_azimuth(column),
            2 * std::numbers::pi);
        const LocalDirection d =
            grid.frame(row).local(AngleParts::of(elevation), AngleParts::of(azimuth / 2));
        double expected = 0;
        for (std::size_t k = 0; k < coefficients.size(); ++k) {
          expected += coefficients[k] * basis.values(k)[cell];
        }
        ASSERT_NEAR(evaluate_local(local, d), expected, 1e-10);
      }
    }
  }
}

}  // namespace
}  // namespace curlidar
