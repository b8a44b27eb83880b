// SPDX-License-Identifier: BSD-3-Clause
#include "dense/row_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kRows = 9, kEvery = 4;  // rows 0, 4, 8 are given
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kWall_m = 10;

/// Rows at 4, 3, .. -4 degrees that always return.
DensityProfile plain_profile() {
  DensityProfile profile;
  profile.name = "rows";
  profile.rows = kRows;
  profile.given_every = kEvery;
  profile.elevation_mdeg = profile.return_permille = profile.given_return_permille =
      profile.bias_mm = RangeTable(kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    profile.elevation_mdeg.row(row).fill(static_cast<std::int16_t>(1000 * (4 - int(row))));
    profile.return_permille.row(row).fill(1000);
    profile.given_return_permille.row(row).fill(1000);
  }
  return profile;
}

/// The given rows inside a round tower; the azimuths from `from` on are open.
RingPoints tower(double from = 4) {
  std::vector<Vec3> positions;
  std::vector<std::uint16_t> rings;
  for (int ring = 0; ring < 3; ++ring) {
    for (int column = 0; column < 360; ++column) {
      const double azimuth = (column - 180) * kDegree;
      if (azimuth >= from) continue;
      const double z = kWall_m * std::tan((4 - 4 * ring) * kDegree);
      positions.push_back({kWall_m * std::cos(azimuth), kWall_m * std::sin(azimuth), z});
      rings.push_back(static_cast<std::uint16_t>(ring));
    }
  }
  return {positions, rings, {4 * kDegree, 0, -4 * kDegree}, 360};
}

TEST(RowRules, SeeAWallWhereItIs) {
  const DensityProfile profile = plain_profile();
  const RingPoints points = tower();
  const RowRules rules(points, profile);
  for (const std::size_t row : {1u, 2u, 3u, 6u}) {
    const RowGuess found = rules.guess_along_row(row, 0.3);
    EXPECT_EQ(found.guess.seen, Seen::surface);
    EXPECT_NEAR(found.guess.r, kWall_m / std::cos((4.0 - double(row)) * kDegree), 2e-3);
  }
}

TEST(RowRules, AddWhatARowMeasuresTooFar) {
  DensityProfile profile = plain_profile();
  profile.bias_mm.row(2).fill(40);
  const RingPoints points = tower();
  const RowRules plain(points, profile);
  EXPECT_NEAR(plain.guess_along_row(2, 0.3).guess.r - plain.guess_along_row(6, 0.3).guess.r, .04,
              1e-3);
  // Rings whose own errors were taken off: half of that of the first, half of the second's.
  const RowRules cleaned(points, profile, errors_of(points), {.01, .03, 0});
  EXPECT_NEAR(cleaned.guess_along_row(2, 0.3).guess.r - plain.guess_along_row(2, 0.3).guess.r, .02,
              1e-3);
}

TEST(RowRules, KnowRowsThatHardlyReturn) {
  DensityProfile profile = plain_profile();
  profile.return_permille.row(2).fill(200);
  const RingPoints points = tower();
  const RowRules rules(points, profile);
  EXPECT_EQ(rules.guess_along_row(2, 0.3).guess.seen, Seen::nothing);
  EXPECT_LT(rules.guess_along_row(2, 0.3).returns, .5);
  EXPECT_EQ(rules.guess_along_row(3, 0.3).guess.seen, Seen::surface);
}

TEST(RowRules, SeeNothingWhereNothingIs) {
  const DensityProfile profile = plain_profile();
  const RingPoints points = tower(1);
  const RowRules rules(points, profile);
  EXPECT_NE(rules.guess_along_row(2, 2).guess.seen, Seen::surface);
  EXPECT_EQ(rules.guess_along_row(2, 2).returns, 0);
  EXPECT_EQ(rules.guess_along_row(2, 1 + 3 * kDegree).guess.seen, Seen::nothing);
}

TEST(RowRules, TreesOfReturnsDecideWhereThereAreSome) {
  DensityProfile profile = plain_profile();
  profile.returns.cuts.resize(kRowFeatures);
  profile.returns.cuts[kPlainFeatures] = {2.5f};  // the row
  profile.returns.depth = 1;
  profile.returns.splits = {{kPlainFeatures, 0}};
  profile.returns.leaves = {-100, 100};
  profile.returns.unit = .01;
  ASSERT_TRUE(validate(profile));
  const RingPoints points = tower();
  const RowRules rules(points, profile);
  EXPECT_EQ(rules.guess_along_row(2, 0.3).guess.seen, Seen::nothing);
  EXPECT_NEAR(rules.guess_along_row(3, 0.3).returns, probability_of(1), 1e-12);
}

TEST(RowRules, FindTheRowOfAPlace) {
  const DensityProfile profile = plain_profile();
  const RingPoints points = tower();
  const RowRules rules(points, profile);
  EXPECT_EQ(rules.row_near(2.9 * kDegree, 10), (NearRow{1, true}));
  EXPECT_EQ(rules.row_near(2.6 * kDegree, 10), (NearRow{1, false}));
  EXPECT_EQ(rules.row_near(3.9 * kDegree, 10), std::nullopt);  // given
  EXPECT_EQ(rules.row_near(20 * kDegree, 10), std::nullopt);
}

TEST(RowRules, FindItByTheStepOnTheSideOfThePlace) {
  DensityProfile profile = plain_profile();
  for (std::size_t row = 0; row < 3; ++row) {  // steps of two degrees above row 3, of one below
    profile.elevation_mdeg.row(row).fill(static_cast<std::int16_t>(1000 * (7 - 2 * int(row))));
  }
  const RingPoints points = tower();
  const RowRules rules(points, profile);
  EXPECT_EQ(rules.row_near(1.45 * kDegree, 10), (NearRow{3, true}));
  EXPECT_EQ(rules.row_near(0.55 * kDegree, 10), (NearRow{3, false}));
  EXPECT_EQ(rules.row_near(3.45 * kDegree, 10), (NearRow{2, true}));
}

TEST(RowRules, EndHalfAStepBeyondTheOutermostRows) {
  DensityProfile profile = plain_profile();
  profile.given_first = 1;  // rows 1 and 5, so that the outermost are asked for
  const RingPoints points = tower();
  const RowRules rules(points, profile);
  EXPECT_EQ(rules.row_near(4.2 * kDegree, 10), (NearRow{0, true}));
  EXPECT_EQ(rules.row_near(4.6 * kDegree, 10), std::nullopt);
  EXPECT_EQ(rules.row_near(-4.4 * kDegree, 10), (NearRow{8, false}));
  EXPECT_EQ(rules.row_near(-4.6 * kDegree, 10), std::nullopt);
}

TEST(RowRules, LeaveRangesAloneThatWouldMakeNoSense) {
  DensityProfile profile = plain_profile();
  profile.bias_mm.row(2).fill(900);
  profile.bias_mm.row(6).fill(-kMaxBias_mm);
  ASSERT_TRUE(validate(profile));
  const RingPoints points = tower();
  const RowRules rules(points, profile, errors_of(points), {0, .4, .4});
  EXPECT_NEAR(rules.guess_along_row(2, 0.3).guess.r, kWall_m, .01);  // 1.1 m are more than a tenth
  EXPECT_NEAR(rules.guess_along_row(6, 0.3).guess.r, kWall_m - .6, .01);
}

TEST(RowRules, AreForTheRingsOfTheProfile) {
  const RingPoints points = tower();
  EXPECT_TRUE(check_rows(plain_profile(), points));
  const auto why_not = [&](const DensityProfile& profile) {
    const Status status = check_rows(profile, points);
    return status ? "" : status.error().message;
  };
  DensityProfile other = plain_profile();
  other.given_every = 2;
  EXPECT_THAT(why_not(other), testing::HasSubstr("5 rings, not for 3"));
  other = plain_profile();
  other.elevation_mdeg.row(4).fill(1700);
  EXPECT_THAT(why_not(other), testing::HasSubstr("ring 1"));
  EXPECT_EQ(why_not({}), "");  // no rows: it fits everything
}

TEST(Features, KnowHowRoughSamplesAreAndHowLargeTheirPatches) {
  const RingPoints points = tower();
  ScanErrors errors = errors_of(points);
  const auto last = [&](double azimuth) {
    Look look = look_along(points, {azimuth, {0, 0}, {1, .01}});
    const PlainFeatures all = plain_features(points, look, decide(points, look), errors);
    return std::vector<float>(all.end() - 4, all.end());
  };
  // A round wall is out of straight by half a degree's arc at most; nothing is coded.
  std::vector<float> found = last(0.3);
  EXPECT_NEAR(found[0], 0, 2e-3);
  EXPECT_NEAR(found[1], 0, 2e-3);
  EXPECT_EQ(found[2], -1);
  EXPECT_EQ(found[3], -1);
  errors.patch_cells.assign(3 * 360, 8);  // of the middle ring 32 cells, the others eight
  std::fill_n(errors.patch_cells.begin() + 360, 360, 32u);
  found = last(0.3);
  EXPECT_EQ(found[2], 3);
  EXPECT_EQ(found[3], 5);
}

TEST(Features, AreNumbersWhateverIsAround) {
  const DensityProfile profile = plain_profile();
  const RingPoints points = tower(1);
  const RowRules rules(points, profile);
  for (const std::size_t row : {1u, 2u, 7u}) {
    for (double azimuth = -3.1; azimuth < 3.1; azimuth += .05) {
      for (const float feature : rules.features(row, rules.look_along_row(row, azimuth))) {
        ASSERT_TRUE(std::isfinite(feature)) << row << " " << azimuth;
      }
    }
  }
}

}  // namespace
}  // namespace curlidar
