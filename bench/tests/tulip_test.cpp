// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/tulip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace curlidar::bench::tulip {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(Tulip, PutsPointsWhereTheOriginalDoes) {
  std::size_t row = 0, column = 0;
  ASSERT_TRUE(locate(direction_of(-24.8 * kDegree, .001) * 10, row, column));
  EXPECT_EQ(row, 0u);
  EXPECT_EQ(column, 512u);
  ASSERT_TRUE(locate(direction_of(2 * kDegree, -.001) * 10, row, column));
  EXPECT_EQ(row, 63u);
  EXPECT_EQ(column, 512u);  // cut towards zero on both sides
  ASSERT_TRUE(locate(direction_of(0, 100 * kDegree) * 10, row, column));
  EXPECT_EQ(row, 58u);
  EXPECT_EQ(column, 512u + 284u);
  ASSERT_TRUE(locate(direction_of(0, -170 * kDegree) * 10, row, column));  // 190 degrees
  EXPECT_EQ(column, (512u + 540u) % 1024u);
  EXPECT_FALSE(locate(direction_of(3 * kDegree, 0), row, column));
  EXPECT_FALSE(locate(direction_of(-26 * kDegree, 0), row, column));
}

TEST(Tulip, TheLastPointOfACellCounts) {
  Cloud cloud;
  for (const double range : {20.0, 10.0}) {
    cloud.positions.push_back(direction_of(0, .5) * range);
    cloud.positions.push_back(direction_of(-.1, .5) * (100 - range));
  }
  const Image image = project(cloud);
  double sum = 0;
  for (const double range : image.range_m) sum += range;
  EXPECT_NEAR(sum, 10, 1e-12);  // 80 m, then 90 m, which is too far
}

Image wall(double range_m) {
  Image image;
  for (double& range : image.range_m) range = range_m;
  return image;
}

TEST(Tulip, APerfectPredictionIsPerfect) {
  const Result<Scores> scores = score(wall(10), wall(10), wall(10));
  ASSERT_TRUE(scores);
  EXPECT_EQ(scores->mae_m, 0);
  EXPECT_EQ(scores->chamfer_m2, 0);
  EXPECT_EQ(scores->iou, 1);
  EXPECT_EQ(scores->f1, 1);
  EXPECT_EQ(scores->mask_iou, 1);
}

TEST(Tulip, RowsThatAreGivenDoNotCountAsPredicted) {
  const Result<Scores> scores = score(wall(11), wall(10), wall(10));
  ASSERT_TRUE(scores);
  EXPECT_NEAR(scores->mae_m, .75, 1e-9);  // three rows of four
  EXPECT_NEAR(scores->both_valid_mae_m, 1, 1e-9);
  // A metre from each wrong point to the nearest right one, which is in a given row.
  EXPECT_NEAR(scores->chamfer_m2, .75 + .75 * .005, .01);
}

TEST(Tulip, EmptyCellsCountInTheMeanAndTheMask) {
  Image predicted = wall(10);
  for (std::size_t column = 0; column < kColumns; ++column) predicted.at(1, column) = 1.5;
  const Result<Scores> scores = score(predicted, wall(10), wall(10));  // 1.5 m is none
  ASSERT_TRUE(scores);
  EXPECT_NEAR(scores->mae_m, 10.0 / 64, 1e-9);
  EXPECT_NEAR(scores->mask_iou, 47.0 / 48, 1e-9);
  EXPECT_NEAR(scores->completeness, 47.0 / 48, 1e-9);
  EXPECT_EQ(scores->both_valid_mae_m, 0);
}

TEST(Tulip, ImagesWithoutARangeCannotBeJudged) {
  EXPECT_FALSE(score({}, {}, wall(10)));
  EXPECT_FALSE(score(wall(10), wall(10), {}));
}

}  // namespace
}  // namespace curlidar::bench::tulip
