// SPDX-License-Identifier: BSD-3-Clause
#include "paper/masks.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "unit/paper/images.hpp"

namespace curlidar {
namespace {

using test::make_image;
using test::small_lattice;

constexpr std::uint32_t kRows = 5, kColumns = 256;
constexpr CliffThresholds kThresholds{2.0, 0.7, 2.1};
using CellSet = std::set<std::pair<std::size_t, std::size_t>>;

CellMasks masks_of(const std::function<double(std::size_t, std::size_t)>& range_of) {
  return make_masks(make_image(Lattice::uniform(kRows, kColumns, 0.02, -0.02), range_of),
                    kThresholds);
}

/// (row, column) of the cells that are set.
CellSet set_cells(const std::vector<std::uint8_t>& mask) {
  CellSet out;
  for (std::size_t cell = 0; cell < mask.size(); ++cell) {
    if (mask[cell]) out.insert({cell / kColumns, cell % kColumns});
  }
  return out;
}

TEST(MakeMasks, SmoothSurfaceHasNoCliffs) {
  const CellMasks masks = masks_of([](std::size_t, std::size_t) { return 10.0; });
  EXPECT_EQ(set_cells(masks.point).size(), kRows * kColumns);
  EXPECT_TRUE(set_cells(masks.cliff_row).empty());
  EXPECT_TRUE(set_cells(masks.cliff_column).empty());
  EXPECT_TRUE(set_cells(masks.cliff_diagonal).empty());
}

TEST(MakeMasks, OneCellThatStandsOut) {
  const CellMasks masks = masks_of(
      [](std::size_t row, std::size_t column) { return row == 2 && column == 100 ? 15.0 : 10.0; });
  EXPECT_EQ(set_cells(masks.cliff_row), (CellSet{{2, 100}, {3, 100}}));
  EXPECT_EQ(set_cells(masks.cliff_column), (CellSet{{2, 100}, {2, 101}}));
  EXPECT_EQ(set_cells(masks.cliff_diagonal), (CellSet{{2, 100}, {3, 101}}));
}

TEST(MakeMasks, ThresholdsActOnTheirOwnDirection) {
  // 1 m: a cliff between columns, none between rows.
  const CellMasks columns = masks_of(
      [](std::size_t, std::size_t column) { return column >= 40 && column < 80 ? 11.0 : 10.0; });
  EXPECT_TRUE(set_cells(columns.cliff_row).empty());
  EXPECT_TRUE(set_cells(columns.cliff_diagonal).empty());
  CellSet expected;
  for (std::size_t row = 0; row < kRows; ++row) {
    expected.insert({row, 40});
    expected.insert({row, 80});
  }
  EXPECT_EQ(set_cells(columns.cliff_column), expected);
  // 2.05 m: between the row and the diagonal threshold.
  const CellMasks rows =
      masks_of([](std::size_t row, std::size_t) { return row >= 3 ? 12.05 : 10.0; });
  EXPECT_TRUE(set_cells(rows.cliff_column).empty());
  EXPECT_EQ(set_cells(rows.cliff_row).size(), kColumns);
  EXPECT_EQ(set_cells(rows.cliff_row).begin()->first, 3u);
  // Diagonal neighbours of 10 m and 12.05 m are sqrt(2.05^2 + ~0.27^2) = 2.07 m apart: none.
  EXPECT_TRUE(set_cells(rows.cliff_diagonal).empty());
}

TEST(MakeMasks, ColumnsWrapAndRowsDoNot) {
  const CellMasks masks = masks_of([](std::size_t row, std::size_t column) {
    return row == 0 && column == kColumns - 1 ? 15.0 : 10.0;
  });
  EXPECT_EQ(set_cells(masks.cliff_column), (CellSet{{0, kColumns - 1}, {0, 0}}));
  EXPECT_EQ(set_cells(masks.cliff_diagonal), (CellSet{{1, 0}}));
  EXPECT_EQ(set_cells(masks.cliff_row), (CellSet{{1, kColumns - 1}}));
}

TEST(MakeMasks, AMissingNeighbourBreaksTheSurface) {
  const CellMasks masks = masks_of(
      [](std::size_t row, std::size_t column) { return row == 2 && column == 0 ? 0.0 : 10.0; });
  EXPECT_EQ(masks.point[masks.index(2, 0)], 0);
  EXPECT_EQ(set_cells(masks.cliff_row), (CellSet{{2, 0}, {3, 0}}));
  EXPECT_EQ(set_cells(masks.cliff_column), (CellSet{{2, 0}, {2, 1}}));
  EXPECT_EQ(set_cells(masks.cliff_diagonal), (CellSet{{2, 0}, {3, 1}}));
  // Nothing lies between two missing ones.
  const CellMasks empty = masks_of([](std::size_t, std::size_t) { return 0.0; });
  EXPECT_TRUE(set_cells(empty.cliff_row).empty());
  EXPECT_TRUE(set_cells(empty.cliff_column).empty());
}

TEST(CellMasks, IndexWrapsColumns) {
  const CellMasks masks(3, 8);
  EXPECT_EQ(masks.index(1, -1), 15u);
  EXPECT_EQ(masks.index(1, 8), 8u);
  EXPECT_EQ(masks.index(2, -17), 23u);
  EXPECT_EQ(masks.index(0, 25), 1u);
}

TEST(CellPosition, SplitsFractionalIndices) {
  const auto expect = [](double value, std::int64_t whole, double fraction) {
    const CellPosition p = CellPosition::of(value, -value);
    EXPECT_EQ(p.row, whole) << value;
    EXPECT_NEAR(p.row_fraction, fraction, 1e-12) << value;
    const CellPosition q = CellPosition::of(0, value);
    EXPECT_EQ(q.column, whole) << value;
    EXPECT_EQ(q.column_fraction, p.row_fraction) << value;
  };
  expect(3, 3, 0);
  expect(3.25, 3, 0.25);
  expect(3 - 1e-10, 3, 0);
  expect(3 + 1e-10, 3, 0);
  expect(3 - 1e-8, 2, 1 - 1e-8);
  expect(-0.5, -1, 0.5);
  expect(-1, -1, 0);
  expect(-1 - 1e-10, -1, 0);
  expect(-2.75, -3, 0.25);
  expect(0, 0, 0);
  EXPECT_EQ(CellPosition::of(3 - 1e-10, 0).row_fraction, 0);
}

/// Two rows of one surface, everything believed.
CellMasks sound(std::uint32_t rows, std::uint32_t columns) {
  CellMasks masks(rows, columns);
  masks.point.assign(masks.point.size(), 1);
  return masks;
}

bool believed_at(const CellMasks& masks, double row, double column) {
  return believed(masks, CellPosition::of(row, column));
}

TEST(Believed, NothingBeyondTheOutermostRows) {
  const CellMasks masks = sound(3, 8);
  EXPECT_TRUE(believed_at(masks, 0, 0));
  EXPECT_TRUE(believed_at(masks, 2, 7.5));
  EXPECT_TRUE(believed_at(masks, 1.99, 0));
  EXPECT_FALSE(believed_at(masks, -0.5, 0));
  EXPECT_FALSE(believed_at(masks, -1, 0));
  EXPECT_FALSE(believed_at(masks, 2.01, 0));
  EXPECT_FALSE(believed_at(masks, 3, 0));
}

TEST(Believed, TheNearestCellMustHoldAReturn) {
  CellMasks masks = sound(3, 8);
  masks.point[masks.index(1, 3)] = 0;
  EXPECT_FALSE(believed_at(masks, 1, 3));
  EXPECT_FALSE(believed_at(masks, 1.49, 3.49));
  EXPECT_FALSE(believed_at(masks, 0.5, 2.5));
  EXPECT_TRUE(believed_at(masks, 1.5, 3));
  EXPECT_TRUE(believed_at(masks, 1, 3.5));
  EXPECT_TRUE(believed_at(masks, 0.49, 3));
  EXPECT_TRUE(believed_at(masks, 1, 2.49));
  // Across the seam.
  masks.point[masks.index(1, 0)] = 0;
  EXPECT_FALSE(believed_at(masks, 1, 7.5));
  EXPECT_FALSE(believed_at(masks, 1, 8));
  EXPECT_TRUE(believed_at(masks, 1, 7.49));
  EXPECT_FALSE(believed_at(masks, 1, -0.25));
}

TEST(Believed, NoCliffMayLieBetween) {
  CellMasks rows = sound(3, 8);
  rows.cliff_row[rows.index(2, 3)] = 1;  // between (1, 3) and (2, 3)
  EXPECT_FALSE(believed_at(rows, 1.1, 3));
  EXPECT_FALSE(believed_at(rows, 1.9, 3.4));
  EXPECT_TRUE(believed_at(rows, 1.9, 3.5));  // nearer column 4
  EXPECT_TRUE(believed_at(rows, 1, 3));
  EXPECT_TRUE(believed_at(rows, 2, 3));
  EXPECT_TRUE(believed_at(rows, 0.5, 3));
  CellMasks columns = sound(3, 8);
  columns.cliff_column[columns.index(1, 0)] = 1;  // between (1, 7) and (1, 0)
  EXPECT_FALSE(believed_at(columns, 1, 7.2));
  EXPECT_FALSE(believed_at(columns, 1.4, -0.2));
  EXPECT_TRUE(believed_at(columns, 1.5, 7.2));
  EXPECT_TRUE(believed_at(columns, 1, 0));
  EXPECT_TRUE(believed_at(columns, 1, 7));
  CellMasks diagonal = sound(3, 8);
  diagonal.cliff_diagonal[diagonal.index(2, 4)] = 1;  // between (1, 3) and (2, 4)
  EXPECT_FALSE(believed_at(diagonal, 1.1, 3.9));
  EXPECT_TRUE(believed_at(diagonal, 1, 3.5));
  EXPECT_TRUE(believed_at(diagonal, 1.5, 3));
  EXPECT_TRUE(believed_at(diagonal, 1.5, 4.5));
}

TEST(Refuse, TakesBackWhatWasBelieved) {
  for (const auto& [row, column] :
       {std::pair<double, double>{1, 3}, {0.5, 3}, {1, 7.5}, {1.25, 7.75}, {1.5, -0.5}}) {
    CellMasks masks = sound(3, 8);
    ASSERT_TRUE(believed_at(masks, row, column));
    refuse(masks, CellPosition::of(row, column));
    EXPECT_FALSE(believed_at(masks, row, column)) << row << " " << column;
    std::size_t changed = 0;
    for (std::size_t cell = 0; cell < masks.point.size(); ++cell) {
      changed += static_cast<std::size_t>(!masks.point[cell]) + masks.cliff_row[cell] +
                 masks.cliff_column[cell] + masks.cliff_diagonal[cell];
    }
    EXPECT_EQ(changed, 1u);
  }
  CellMasks masks = sound(3, 8);
  refuse(masks, CellPosition::of(0.5, 7.5));
  EXPECT_EQ(masks.cliff_diagonal[masks.index(1, 0)], 1);
}

}  // namespace
}  // namespace curlidar
