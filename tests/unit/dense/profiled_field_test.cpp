// SPDX-License-Identifier: BSD-3-Clause
// Fields with density profiles: where these have a say, and that none makes nonsense of a field.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "support/density.hpp"

namespace curlidar {
namespace {

using test::one_question;
using test::tower_profile;

constexpr double kDegree = std::numbers::pi / 180;

RangeEstimate told(const DensityProfile& profile, bool rows_of_profile, double up) {
  const auto field = dense_field(
      test::tower_field(),
      {DenseStrategy::best, std::make_shared<DensityProfile>(profile), rows_of_profile});
  return test::told_along(*field, {{{}, direction_of(up * kDegree, 0.3)}})[0];
}

RangeEstimate told_by_rules(double up) {
  return test::told_along(*dense_field(test::tower_field()),
                          {{{}, direction_of(up * kDegree, 0.3)}})[0];
}

/// Profiles at the ends of what is valid.
std::vector<DensityProfile> extreme_profiles() {
  std::vector<DensityProfile> profiles;
  for (const int sign : {-1, 1}) {
    const auto most = static_cast<std::int16_t>(sign * 32767);
    DensityProfile biased = tower_profile();
    for (std::size_t row = 0; row < biased.rows; ++row) {
      biased.bias_mm.row(row).fill(static_cast<std::int16_t>(sign * kMaxBias_mm));
      biased.return_permille.row(row).fill(static_cast<std::int16_t>(sign > 0 ? 1000 : 0));
    }
    profiles.push_back(biased);
    DensityProfile trees = tower_profile();
    trees.residual = one_question(kRowFeatures, 5, 8, most, most, kMaxTreeNumber);
    trees.returns = one_question(kRowFeatures, 5, 8, 32767, 32767, kMaxTreeNumber);
    trees.confidence = one_question(kPlainFeatures, 5, 8, most, most, kMaxTreeNumber);
    profiles.push_back(trees);
    trees.row_confidence = one_question(kRowFeatures, 5, 8, most, most, kMaxTreeNumber);
    trees.residual.unit = 3e-6;  // just below a tenth
    profiles.push_back(trees);
    DensityProfile elsewhere = tower_profile();
    for (std::size_t row = 0; row < elsewhere.rows; ++row) {
      elsewhere.elevation_mdeg.row(row).fill(static_cast<std::int16_t>(sign * 30000));
    }
    elsewhere.confidence = trees.confidence;
    profiles.push_back(elsewhere);
    DensityProfile unordered = tower_profile();
    for (const std::size_t row : {1u, 2u, 3u, 5u, 6u, 7u}) {
      unordered.elevation_mdeg.row(row).fill(static_cast<std::int16_t>(sign * 400 * int(row)));
    }
    profiles.push_back(unordered);
  }
  return profiles;
}

TEST(ProfiledField, MakesSenseWhateverAValidProfileSays) {
  for (const DensityProfile& profile : extreme_profiles()) {
    ASSERT_TRUE(validate(profile)) << validate(profile).error().message;
    EXPECT_EQ(test::fault_with(profile), "") << density_profile_text(profile).substr(0, 500);
  }
}

TEST(ProfiledField, BiasesAreOfLinesThatNameARow) {
  DensityProfile profile = tower_profile();
  for (std::size_t row = 0; row < profile.rows; ++row) profile.bias_mm.row(row).fill(100);
  for (const double up : {3.0, 2.1, 0.9}) {  // of rows 1, 2, 3
    const double rules = told_by_rules(up).range_m;
    EXPECT_NEAR(told(profile, true, up).range_m, rules + .1, 1e-9) << up;
    EXPECT_EQ(told(profile, false, up).range_m, rules) << up;
  }
  for (const double up : {2.6, 0.1, 4.0, -3.9}) {  // between rows; of given rows
    EXPECT_EQ(told(profile, true, up).range_m, told_by_rules(up).range_m) << up;
  }
}

TEST(ProfiledField, GivenRowsMeasureWhatTheirRingsDo) {
  const auto profile = std::make_shared<DensityProfile>(tower_profile());
  const auto far = [&](bool rows_of_profile, double up) {
    const auto field =
        dense_field(test::tower_field(.04), {DenseStrategy::best, profile, rows_of_profile});
    return test::told_along(*field, {{{}, direction_of(up * kDegree, 0.3)}})[0].range_m -
           told_by_rules(up).range_m;
  };
  for (const double up : {4.0, 3.8, 0.1, -3.9}) {
    EXPECT_NEAR(far(true, up), .04, 1e-9) << up;
    EXPECT_EQ(far(false, up), 0) << up;
  }
  EXPECT_EQ(far(true, 0.4), 0);  // between rows
}

TEST(ProfiledField, RowsThatHardlyReturnDoSoForAllWhoAskThere) {
  DensityProfile profile = tower_profile();
  profile.return_permille.row(2).fill(100);
  profile.return_permille.row(4).fill(100);  // given: means nothing
  for (const bool rows_of_profile : {false, true}) {
    EXPECT_EQ(told(profile, rows_of_profile, 2.0).seen, Seen::nothing);
    EXPECT_EQ(told(profile, rows_of_profile, 1.7).seen, Seen::nothing);
    EXPECT_EQ(told(profile, rows_of_profile, 3.0).seen, Seen::surface);
    EXPECT_EQ(told(profile, rows_of_profile, 0.0).seen, Seen::surface);
  }
}

TEST(ProfiledField, IsNotSureOfWhatHardlyEverReturns) {
  DensityProfile profile = tower_profile();
  profile.return_permille.row(2).fill(100);
  const RangeEstimate rare = told(profile, false, 2.0);
  EXPECT_EQ(rare.seen, Seen::nothing);
  EXPECT_LT(rare.confidence, 0.5F);
  EXPECT_GT(told_by_rules(2.0).confidence, rare.confidence);
}

TEST(ProfiledField, ConfidenceOfARowIsOfWhatTheRowMeasures) {
  DensityProfile profile = tower_profile();
  profile.row_confidence = one_question(kRowFeatures, kPlainFeatures, 1.5F, -100, 100);
  EXPECT_NEAR(told(profile, true, 3.0).confidence, probability_of(-1), 1e-6);
  EXPECT_NEAR(told(profile, true, 2.0).confidence, probability_of(1), 1e-6);
  for (const double up : {3.0, 2.0}) {
    EXPECT_EQ(told(profile, false, up).confidence, told_by_rules(up).confidence) << up;
  }
}

TEST(ProfiledField, WithoutRowsAProfileTellsConfidenceOfEveryField) {
  DensityProfile profile;
  profile.confidence = one_question(kPlainFeatures, 5, 100, 100, -100);  // the range in metres
  ASSERT_TRUE(check_density_profile(profile, *test::tower_field()));
  EXPECT_NEAR(told(profile, false, 1.3).confidence, probability_of(1), 1e-6);
}

TEST(ProfiledField, LeavesAProfileForOtherRingsAside) {
  DensityProfile profile = tower_profile();
  profile.given_every = 2;
  profile.confidence = one_question(kPlainFeatures, 5, 100, 100, -100);
  ASSERT_FALSE(check_density_profile(profile, *test::tower_field()));
  EXPECT_EQ(told(profile, true, 2.0).confidence, told_by_rules(2.0).confidence);
}

TEST(ProfiledField, OnlyDenseFieldsTellConfidence) {
  const auto masks = dense_field(test::tower_field(), {DenseStrategy::masks});
  EXPECT_TRUE(std::isnan(test::told_along(*masks, {{{}, {1, 0, 0}}})[0].confidence));
  EXPECT_TRUE(std::isnan(RangeEstimate{}.confidence));
  EXPECT_EQ(test::told_along(*dense_field(test::tower_field()), {{{}, {-1, 0, 0}}})[0].confidence,
            0.0F);
}

}  // namespace
}  // namespace curlidar
