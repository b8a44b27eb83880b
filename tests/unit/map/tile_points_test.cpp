// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "map/sample_grid.hpp"
#include "map/tile_points.hpp"

namespace curlidar {
namespace {

MapTile one_leaf(std::uint8_t axis) {
  MapTile tile;
  tile.side_m = 32;
  MapLeaf leaf;
  leaf.centre = {1.5, 2.5, 3.5};
  leaf.size_m = 1;
  leaf.axis = axis;
  leaf.height_m = 1.5 + axis;
  leaf.slope = {0.25, -0.5};
  leaf.curve = {0.125, 0, 0};
  leaf.cells = 2;
  tile.leaves = {leaf};
  tile.footprint = {1, 0, 0, 1};
  return tile;
}

TEST(TilePoints, LieOnTheSurfaceWithinTheFootprint) {
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    const MapTile tile = one_leaf(axis);
    const std::vector<MapSample> points = tile_points(tile, 0.1);
    ASSERT_EQ(points.size(), 2u * 5 * 5);
    for (const MapSample& sample : points) {
      const double p[] = {sample.position.x - 1.5, sample.position.y - 2.5,
                          sample.position.z - 3.5};
      const double u = p[(axis + 1) % 3], v = p[(axis + 2) % 3];
      EXPECT_EQ(u < 0, v < 0);
      EXPECT_LT(std::abs(u), 0.5);
      EXPECT_NEAR(p[axis], 0.25 * u - 0.5 * v + 0.125 * u * u, 1e-12);
    }
  }
}

TEST(TilePoints, NoneFarOutsideOfTheCube) {
  MapTile tile = one_leaf(2);
  tile.leaves[0].height_m = 3.9;  // the cube ends at 4
  tile.leaves[0].slope = {1.5, 0};
  tile.leaves[0].curve = {};
  for (const MapSample& sample : tile_points(tile, 0.01)) {
    EXPECT_LE(sample.position.z, 4 + kLeafSlack_m);
  }
  // All of one cell, and of the other what lies below .1 m of u.
  EXPECT_EQ(tile_points(tile, 0.01).size(), 50u * 50 + 10 * 50);
}

TEST(SampleGrid, MeansInAnyOrder) {
  SampleGrid there, back;
  std::vector<Vec3> points;
  for (int i = 0; i < 500; ++i) {
    points.push_back({std::fmod(i * 0.137, 0.7), std::fmod(i * 0.071, 0.3), -0.3 + i * 1e-3});
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_TRUE(there.add(points[i], 0.1f * static_cast<float>(i % 7)));
    const std::size_t j = points.size() - 1 - i;
    EXPECT_TRUE(back.add(points[j], 0.1f * static_cast<float>(j % 7)));
  }
  const auto a = there.samples(), b = back.samples();
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 10u);
  EXPECT_LT(a.size(), 500u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].position, b[i].position);
    EXPECT_EQ(a[i].intensity, b[i].intensity);
    EXPECT_EQ(a[i].weight, b[i].weight);
    EXPECT_LE(a[i].weight, SampleGrid::kMostWeight);
  }
}

TEST(SampleGrid, OnePointComesBack) {
  SampleGrid grid;
  ASSERT_TRUE(grid.add({1.234, 31.999, -7.5}, std::nanf("")));
  const std::vector<MapSample> samples = grid.samples();
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_NEAR(samples[0].position.x, 1.234, 2e-6);
  EXPECT_NEAR(samples[0].position.y, 31.999, 2e-6);
  EXPECT_NEAR(samples[0].position.z, -7.5, 2e-6);
  EXPECT_TRUE(std::isnan(samples[0].intensity));
}

TEST(SampleGrid, RefusesWhatIsNowhere) {
  SampleGrid grid;
  EXPECT_FALSE(grid.add({std::nan(""), 0, 0}, 0));
  EXPECT_FALSE(grid.add({0, INFINITY, 0}, 0));
  EXPECT_FALSE(grid.add({0, 0, 1e9}, 0));
  EXPECT_TRUE(grid.empty());
}

}  // namespace
}  // namespace curlidar
