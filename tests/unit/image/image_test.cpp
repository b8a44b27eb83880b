// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "curlidar/lattice.hpp"
#include "curlidar/project.hpp"
#include "image/range_image.hpp"
#include "support/scans.hpp"

namespace curlidar {
namespace {

using test::kDegree;

Cloud cloud_of(std::vector<Vec3> points) {
  Cloud cloud;
  cloud.positions = std::move(points);
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  return cloud;
}

Detection detection_of(const Cloud& cloud) {
  return assign_rings(cloud, test::small_sensor(4, 8)).value();
}

TEST(Lattice, UniformRowsReachBothEdgesOfTheField) {
  const Lattice lattice = Lattice::uniform(64, 1024, 2 * kDegree, -24.9 * kDegree);
  EXPECT_DOUBLE_EQ(lattice.elevation(0), 2 * kDegree);
  EXPECT_DOUBLE_EQ(lattice.elevation(63), -24.9 * kDegree);
  EXPECT_DOUBLE_EQ(lattice.azimuth(0), -std::numbers::pi);
  EXPECT_DOUBLE_EQ(lattice.azimuth(512), 0);
}

TEST(Lattice, RowsAndColumnsInvertElevationsAndAzimuths) {
  const Lattice uneven = Lattice::from_rings({0.3, 0.1, 0.05, -0.4}, 360);
  for (double row = -1.5; row < 5; row += 0.25) {
    EXPECT_NEAR(uneven.row_of(uneven.elevation(row)), row, 1e-12);
  }
  for (double column = 0; column < 360; column += 0.7) {
    EXPECT_NEAR(uneven.column_of(uneven.azimuth(column)), column, 1e-9);
    EXPECT_NEAR(uneven.column_of(uneven.azimuth(column) + 4 * std::numbers::pi), column, 1e-9);
  }
  EXPECT_LT(uneven.column_of(std::nextafter(-std::numbers::pi, -4)), 360);
}

TEST(Lattice, TakesAnyNumberForAColumnAndARow) {
  const Lattice lattice = Lattice::from_rings({0.3, 0.1, 0.05, -0.4}, 360);
  EXPECT_EQ(lattice.within_turn(-0.5), 359.5);
  EXPECT_EQ(lattice.within_turn(720), 0);
  const double infinite = HUGE_VAL, nan = std::nan("");
  for (const double any : {1e300, -1e300, 1e17, -1e17, -1e-300, infinite, -infinite, nan}) {
    EXPECT_GE(lattice.within_turn(any), 0) << any;
    EXPECT_LT(lattice.within_turn(any), 360) << any;
    EXPECT_LT(lattice.column_of(any), 360) << any;
  }
  EXPECT_TRUE(std::isnan(lattice.elevation(nan)));
}

TEST(Lattice, DenseGridKeepsTheLastRowAndAddsAboveTheFirst) {
  const Lattice lattice = Lattice::uniform(64, 1024, 2 * kDegree, -24.9 * kDegree);
  const DenseGrid twice(lattice, 2, 2);
  EXPECT_EQ(twice.rows, 128u);
  EXPECT_EQ(twice.columns, 2048u);
  EXPECT_DOUBLE_EQ(twice.row(127), 63);
  EXPECT_DOUBLE_EQ(twice.row(0), -0.5);
  EXPECT_DOUBLE_EQ(twice.column(3), 1.5);
  EXPECT_EQ(DenseGrid(lattice, 1.5, 0.25).rows, 96u);
  EXPECT_EQ(DenseGrid(lattice, 1e-9, 1e-9).rows, 1u);
}

TEST(Projection, TheReturnNearestTheCentreWinsItsCell) {
  // Cells of the small sensor: rows at 10, 0, -10, -20 degrees, columns every 45 degrees.
  const Cloud cloud =
      cloud_of({direction_of(2 * kDegree, 5 * kDegree) * 10,
                direction_of(1 * kDegree, 1 * kDegree) * 20, direction_of(0, -8 * kDegree) * 5});
  ProjectionCounts counts;
  const Cloud grid = project(cloud, detection_of(cloud), {.columns = 8}, &counts).value();
  ASSERT_EQ(grid.width, 8u);
  ASSERT_EQ(grid.height, 4u);
  EXPECT_EQ(counts.kept, 1u);
  EXPECT_EQ(counts.collided, 2u);
  const Vec3& p = grid.positions[1 * 8 + 4];
  EXPECT_NEAR(p.x, 20, 1e-9);  // on the cell's centre direction, at the winner's range
  EXPECT_NEAR(p.y, 0, 1e-9);
  EXPECT_EQ(count_returns(grid), 1u);
}

TEST(Projection, NothingIsClampedIntoTheFieldOfView) {
  const Cloud cloud =
      cloud_of({direction_of(14.9 * kDegree, 0) * 10, direction_of(15.1 * kDegree, 1) * 10,
                direction_of(-24.9 * kDegree, 2) * 10, direction_of(-25.1 * kDegree, 3) * 10});
  ProjectionCounts counts;
  const Cloud grid = project(cloud, detection_of(cloud), {.columns = 8}, &counts).value();
  EXPECT_EQ(counts.kept, 2u);
  EXPECT_EQ(counts.out_of_fov, 2u);
}

TEST(Projection, ColumnsWrapAtTheSeam) {
  const Cloud cloud = cloud_of({direction_of(0, 179 * kDegree) * 10});
  const Cloud grid = project(cloud, detection_of(cloud), {.columns = 8}).value();
  EXPECT_TRUE(is_return(grid.positions[1 * 8 + 0]));
}

TEST(Projection, RangeLimitsAndPercentiles) {
  std::vector<Vec3> points;
  for (int i = 0; i < 101; ++i) points.push_back(direction_of(0, 0) * (1 + i));
  points.push_back({});
  const Cloud cloud = cloud_of(points);
  EXPECT_DOUBLE_EQ(resolve_max_range({0, 90}, cloud, {}), 91);
  EXPECT_DOUBLE_EQ(resolve_max_range({42, 0}, cloud, {}), 42);
  ProjectionCounts counts;
  ASSERT_TRUE(project(cloud, detection_of(cloud),
                      {.columns = 8, .min_range_m = 11, .max_range = {0, 90}}, &counts));
  EXPECT_EQ(counts.returns, 101u);
  EXPECT_EQ(counts.out_of_range, 20u);
}

TEST(Projection, RowsOfTrueRings) {
  SensorProfile sensor = test::small_sensor(3, 8);
  sensor.rings[1].elevation = 9 * kDegree;  // far from uniform
  const Cloud cloud = cloud_of({direction_of(8.8 * kDegree, 0) * 10});
  const Detection detection = assign_rings(cloud, sensor).value();
  const Cloud grid = project(cloud, detection, {.row_rule = RowRule::rings, .columns = 8}).value();
  EXPECT_EQ(grid.height, 3u);
  EXPECT_TRUE(is_return(grid.positions[1 * 8 + 4]));
  // The row looks where the ring's returns are seen, whatever its nominal elevation.
  EXPECT_NEAR(elevation_of(grid.positions[1 * 8 + 4]), 8.8 * kDegree, 1e-12);
}

TEST(Projection, RejectsNonsense) {
  const Cloud cloud = cloud_of({{1, 0, 0}});
  const Detection detection = detection_of(cloud);
  EXPECT_FALSE(project(cloud, detection, {.columns = 1}));
  EXPECT_FALSE(project(cloud, detection, {.columns = 8, .min_range_m = -1}));
  EXPECT_FALSE(project(cloud, detection, {.columns = 8, .max_range = {0, 101}}));
  EXPECT_FALSE(project(cloud_of({{1, 0, 0}, {2, 0, 0}}), detection, {.columns = 8}));
}

}  // namespace
}  // namespace curlidar
