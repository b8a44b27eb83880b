// SPDX-License-Identifier: BSD-3-Clause
#include "paper/upsample.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "paper/raycast.hpp"
#include "unit/paper/images.hpp"

namespace curlidar {
namespace {

using test::make_image;
using test::random_image;
using test::small_lattice;

constexpr CliffThresholds kNoCliffs{1e6, 1e6, 1e6};

TEST(Upsample, FactorOneReturnsTheOriginals) {
  test::Random random(31);
  const RangeImage image = random_image(small_lattice(6, 20), 0.6, random);
  const SampleImage s = upsample(image, PolarMesh{}, make_masks(image, kNoCliffs), 1, 1, 0.1, 1);
  EXPECT_EQ(s.range, image.range);
  EXPECT_EQ(s.rows, 6u);
  EXPECT_EQ(s.columns, 20u);
}

TEST(Upsample, CopiesOriginalsAndStaysInsideTheMasks) {
  test::Random random(32);
  const RangeImage image = random_image(small_lattice(10, 40), 0.7, random);
  const CellMasks masks = make_masks(image, {6, 5, 7});
  const PolarMesh mesh = make_polar_mesh(image);
  for (const auto& [rows, columns] :
       {std::pair<std::uint32_t, std::uint32_t>{2, 2}, {4, 1}, {1, 3}, {3, 2}}) {
    const SampleImage s = upsample(image, mesh, masks, rows, columns, 0.1, 1);
    ASSERT_EQ(s.rows, 10 * rows);
    ASSERT_EQ(s.columns, 40 * columns);
    ASSERT_EQ(s.range.size(), s.rows * s.columns);
    std::size_t originals = 0, between = 0;
    for (std::size_t i = 0; i < s.rows; ++i) {
      for (std::size_t j = 0; j < s.columns; ++j) {
        const double range = s.range[s.index(i, j)];
        const bool on_cell = i % rows == rows - 1 && j % columns == 0;
        if (on_cell) {
          EXPECT_EQ(range, image.range[image.index(i / rows, j / columns)]);
          originals += range > 0;
          continue;
        }
        if (range == 0) continue;
        ++between;
        EXPECT_TRUE(believed(masks, s.position(i, j)));
        EXPECT_GT(range, 0);
        EXPECT_LE(range, 20);
      }
    }
    EXPECT_EQ(s.count(), originals + between);
    EXPECT_GT(between, 0u);
  }
}

TEST(Upsample, PositionsAreThoseOfTheDenseGrid) {
  const SampleImage s{3, 4, 15, 32, {}};
  const DenseGrid grid(small_lattice(5, 8), 3, 4);
  for (std::size_t i = 0; i < s.rows; ++i) {
    for (std::size_t j = 0; j < s.columns; ++j) {
      const CellPosition expected = CellPosition::of(grid.row(i), grid.column(j));
      const CellPosition p = s.position(i, j);
      EXPECT_EQ(p.row, expected.row) << i;
      EXPECT_NEAR(p.row_fraction, expected.row_fraction, 1e-12);
      EXPECT_EQ(p.column, expected.column);
      EXPECT_NEAR(p.column_fraction, expected.column_fraction, 1e-12);
    }
  }
}

TEST(Upsample, RefusesHitsOnTheLargestTriangles) {
  test::Random random(33);
  const RangeImage image = random_image(small_lattice(8, 32), 1.0, random);
  const CellMasks masks = make_masks(image, kNoCliffs);
  const PolarMesh mesh = make_polar_mesh(image);
  const DenseGrid grid(image.lattice, 2, 2);
  const RayHits hits = cast_rays(mesh, image.lattice, grid,
                                 std::vector<std::uint8_t>(grid.rows * grid.columns, 1), 1);
  std::size_t before = SIZE_MAX;
  for (const double share : {0.0, 0.3, 0.8, 1.0}) {
    const auto refused = largest_triangles(mesh, share);
    const SampleImage s = upsample(image, mesh, masks, 2, 2, share, 1);
    for (std::size_t i = 0; i < s.rows; ++i) {
      for (std::size_t j = 0; j < s.columns; ++j) {
        const std::size_t cell = s.index(i, j);
        if ((i % 2 == 1 && j % 2 == 0) || i == 0) continue;
        EXPECT_EQ(s.range[cell], refused[hits.triangle[cell]] ? 0 : hits.range[cell]);
      }
    }
    EXPECT_LT(s.count(), before);
    before = s.count();
  }
  EXPECT_EQ(before, 8u * 32u);  // originals stay
}

TEST(Upsample, RecoversAPlane) {
  // A tilted ground seen from 1.8 m above it.
  const Vec3 normal{0.05, -0.03, 1};
  const Lattice lattice = Lattice::uniform(32, 256, -8 * test::kDegree, -25 * test::kDegree);
  const auto range_at = [&](double row, double column) {
    return -1.8 / dot(lattice.direction(row, column), normal);
  };
  const RangeImage image = make_image(lattice, [&](std::size_t row, std::size_t column) {
    return range_at(static_cast<double>(row), static_cast<double>(column));
  });
  const SampleImage s =
      upsample(image, make_polar_mesh(image), make_masks(image, kNoCliffs), 3, 2, 0, 1);
  const DenseGrid grid(lattice, 3, 2);
  // Along the first row, below the horizon, edges run under the row: rays pass over them.
  for (std::size_t i = 3; i < s.rows; ++i) {
    for (std::size_t j = 0; j < s.columns; ++j) {
      EXPECT_NEAR(s.range[s.index(i, j)], range_at(grid.row(i), grid.column(j)), 1e-9);
    }
  }
}

TEST(Upsample, SameForAnyNumberOfThreads) {
  test::Random random(34);
  const RangeImage image = random_image(small_lattice(10, 40), 0.7, random);
  const CellMasks masks = make_masks(image, {6, 5, 7});
  const PolarMesh mesh = make_polar_mesh(image);
  EXPECT_EQ(upsample(image, mesh, masks, 2, 2, 0.1, 1).range,
            upsample(image, mesh, masks, 2, 2, 0.1, 4).range);
}

TEST(Upsample, EmptyImageStaysEmpty) {
  const RangeImage image =
      make_image(small_lattice(4, 8), [](std::size_t, std::size_t) { return 0.0; });
  EXPECT_EQ(
      upsample(image, make_polar_mesh(image), make_masks(image, kNoCliffs), 2, 2, 0.1, 2).count(),
      0u);
}

}  // namespace
}  // namespace curlidar
