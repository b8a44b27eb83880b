// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "curlidar/reconstruct.hpp"
#include "support/scans.hpp"

namespace curlidar {
namespace {

DecodedScan decoded_room() {
  return decode(encode(test::small_scan("room"), test::small_settings())->bytes).value();
}

TEST(Reconstruct, PointsLieOnTheDirectionsOfTheDenseGrid) {
  const DecodedScan scan = decoded_room();
  for (const auto& [rows, columns] : {std::pair{1.0, 1.0}, {2.0, 2.0}, {1.5, 2.25}, {0.5, 0.3}}) {
    const Cloud cloud =
        reconstruct(scan, {.rows = rows, .columns = columns, .organised = true}).value();
    const DenseGrid grid(scan.field->lattice(), rows, columns);
    ASSERT_EQ(cloud.size(), grid.rows * grid.columns);
    EXPECT_EQ(cloud.height, grid.rows);
    std::size_t returns = 0;
    for (std::size_t i = 0; i < grid.rows; ++i) {
      for (std::size_t j = 0; j < grid.columns; ++j) {
        const Vec3& p = cloud.positions[i * grid.columns + j];
        if (!is_return(p)) continue;
        ++returns;
        const Vec3 d = scan.field->lattice().direction(grid.row(i), grid.column(j));
        ASSERT_NEAR(dot(p, d), norm(p), 1e-9 * norm(p));
      }
    }
    EXPECT_GT(returns, cloud.size() / 3) << rows << " x " << columns;
  }
}

TEST(Reconstruct, DenserGridsContainTheCodedReturns) {
  const DecodedScan scan = decoded_room();
  const Cloud plain = reconstruct(scan, {.organised = true}).value();
  const Cloud dense = reconstruct(scan, {.rows = 3, .columns = 2, .organised = true}).value();
  const std::size_t columns = plain.width;
  for (std::size_t row = 0; row < plain.height; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const Vec3& a = plain.positions[row * columns + column];
      const Vec3& b = dense.positions[(row * 3 + 2) * dense.width + column * 2];
      ASSERT_EQ(is_return(a), is_return(b));
      if (is_return(a)) {
        ASSERT_LT(norm(a - b), 1e-9);
      }
    }
  }
  EXPECT_GT(count_returns(dense), 4 * count_returns(plain));
}

TEST(Reconstruct, WithoutMasksEveryCellWithAPatchHasAPoint) {
  const DecodedScan scan = decoded_room();
  const Cloud with = reconstruct(scan, {.rows = 2}).value();
  const Cloud without = reconstruct(scan, {.rows = 2, .masks = false}).value();
  EXPECT_GT(without.size(), with.size());
  for (const Vec3& p : without.positions) ASSERT_TRUE(is_return(p));
}

TEST(Reconstruct, DenseCloudOfARoomStaysOnItsSurfaces) {
  const auto room = make_scene("room").value();
  const DecodedScan scan = decoded_room();
  const DenseGrid grid(scan.field->lattice(), 4, 2);
  const Cloud dense = reconstruct(scan, {.rows = 4, .columns = 2, .organised = true}).value();
  std::vector<double> errors;
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const Vec3& p = dense.positions[i * grid.columns + j];
      Hit hit;
      if (is_return(p) &&
          room->cast({}, scan.field->lattice().direction(grid.row(i), grid.column(j)), hit)) {
        errors.push_back(std::abs(norm(p) - hit.range_m));
      }
    }
  }
  ASSERT_GT(errors.size(), 10'000u);
  EXPECT_LT(percentile(errors, 0.5), 0.05);
  EXPECT_LT(percentile(errors, 0.9), 0.3);
}

TEST(Reconstruct, FieldIsContinuousInAzimuthAcrossTheSeamAndWithinPatches) {
  const DecodedScan scan = decoded_room();
  const double columns = scan.field->lattice().columns();
  const auto range_at = [&](double row, double column) {
    double range = 0;
    scan.field->evaluate_row(row, std::span(&column, 1), false, std::span(&range, 1));
    return range;
  };
  std::size_t compared = 0;
  for (double row = 0.25; row < 23; row += 0.5) {
    EXPECT_EQ(std::isnan(range_at(row, 0)), std::isnan(range_at(row, columns)));
    for (double column = -3; column < 6; column += 0.13) {
      const double here = range_at(row, column), around = range_at(row, column + columns);
      if (std::isnan(here)) continue;
      ASSERT_NEAR(here, around, 1e-9);  // one turn on
      // Patches end halfway between dense cells (4 columns of 2 cells each); inside they are
      // smooth.
      const double dense = column * 2 + 0.5, to_border = std::abs(std::remainder(dense, 8.0));
      const double next = range_at(row, column + 1e-6);
      if (to_border > 1e-3 && !std::isnan(next)) {
        ASSERT_NEAR(here, next, 1e-3);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 500u);
}

TEST(Reconstruct, RefusesFactorsThatMakeNoSense) {
  const DecodedScan scan = decoded_room();
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    EXPECT_FALSE(reconstruct(scan, {.rows = bad}));
    EXPECT_FALSE(reconstruct(scan, {.columns = bad}));
  }
}

}  // namespace
}  // namespace curlidar
