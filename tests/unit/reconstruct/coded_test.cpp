// SPDX-License-Identifier: BSD-3-Clause
// Coded returns stay what they are, whatever is asked of the points between them.
#include <gtest/gtest.h>

#include <cmath>

#include "support/scene_field.hpp"

namespace curlidar {
namespace {

using test::BoxScene;

DecodedScan decoded(Profile profile) {
  if (profile == Profile::compact) {
    return test::compact_scan(BoxScene(true), test::small_sensor());
  }
  EncodeSettings settings = test::small_settings();
  settings.profile = profile;
  settings.paper = for_profile(settings.paper, profile);
  settings.paper.global_degree = 6;
  settings.attributes = std::vector<std::string>{"intensity", "ring"};
  return decode(encode(test::small_scan("room"), settings)->bytes).value();
}

class CodedReturns : public testing::TestWithParam<Profile> {};

TEST_P(CodedReturns, AreSureOriginalsOfEveryStrategy) {
  const DecodedScan scan = decoded(GetParam());
  const Cloud plain = reconstruct(scan).value();
  ASSERT_GT(plain.size(), 3000u);
  for (const DenseStrategy strategy : {DenseStrategy::best, DenseStrategy::masks}) {
    for (const bool keep : {false, true}) {
      ReconstructSettings settings{.strategy = strategy, .min_confidence = 0.9};
      settings.confidence = settings.original = true;
      settings.keep_originals = keep;
      const auto cloud = reconstruct(scan, settings);
      ASSERT_TRUE(cloud) << cloud.error().message;
      ASSERT_EQ(cloud->positions, plain.positions);
      for (std::size_t i = 0; i < cloud->size(); ++i) {
        ASSERT_EQ(cloud->find("confidence")->as_double(i), 1);
        ASSERT_EQ(cloud->find("original")->as_double(i), 1);
      }
      for (const Attribute& a : plain.attributes) EXPECT_EQ(cloud->find(a.name)->values, a.values);
    }
  }
}

TEST_P(CodedReturns, OfTheGridAreThoseOfTheList) {
  const DecodedScan scan = decoded(GetParam());
  const Cloud plain = reconstruct(scan).value();
  const Cloud grid = reconstruct(scan, {.organised = true, .original = true}).value();
  ASSERT_EQ(grid.size(), scan.field->lattice().cells());
  std::size_t next = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const bool there = is_return(grid.positions[i]);
    ASSERT_EQ(grid.find("original")->as_double(i), there ? 1 : 0);
    if (!there) continue;
    ASSERT_LT(next, plain.size());
    ASSERT_EQ(grid.positions[i], plain.positions[next]);
    for (const Attribute& a : plain.attributes) {
      ASSERT_EQ(grid.find(a.name)->as_double(i), a.as_double(next));
    }
    ++next;
  }
  EXPECT_EQ(next, plain.size());
}

TEST_P(CodedReturns, OfADenserGridAreThereOnlyIfTheyAreKept) {
  const DecodedScan scan = decoded(GetParam());
  const std::size_t coded = reconstruct(scan)->size();
  ReconstructSettings settings{.rows = 2, .strategy = DenseStrategy::best, .original = true};
  const auto originals = [&] {
    const Cloud cloud = reconstruct(scan, settings).value();
    double sum = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) sum += cloud.find("original")->as_double(i);
    return sum;
  };
  EXPECT_EQ(originals(), 0);
  settings.keep_originals = true;
  settings.min_confidence = 1;
  EXPECT_EQ(originals(), static_cast<double>(coded));
}

TEST_P(CodedReturns, CountAgainstTheLimit) {
  const DecodedScan scan = decoded(GetParam());
  const std::size_t coded = reconstruct(scan)->size(), cells = scan.field->lattice().cells();
  EXPECT_EQ(reconstruct(scan, {.max_points = coded - 1}).error().code, ErrorCode::limit_exceeded);
  ReconstructSettings settings{.rows = 2, .keep_originals = true, .max_points = 2 * cells};
  EXPECT_EQ(reconstruct(scan, settings).error().code, ErrorCode::limit_exceeded);
  settings.max_points += coded;
  EXPECT_TRUE(reconstruct(scan, settings));
}

INSTANTIATE_TEST_SUITE_P(All, CodedReturns,
                         testing::Values(Profile::paper, Profile::paper_1to1, Profile::paper_global,
                                         Profile::compact),
                         test::profile_test_name);

TEST(Reconstruct, MasksTellNoConfidence) {
  const DecodedScan paper = decoded(Profile::paper), compact = decoded(Profile::compact);
  const auto refused = [](const DecodedScan& scan, const ReconstructSettings& settings) {
    const auto cloud = reconstruct(scan, settings);
    return !cloud && cloud.error().code == ErrorCode::invalid_argument &&
           cloud.error().message.find("strategy best") != std::string::npos &&
           !reconstruct_density(scan, 10, settings) && !reconstruct_sensor(scan, {}, settings);
  };
  const ReconstructSettings sure{.rows = 2, .min_confidence = 0.1};
  const ReconstructSettings told{.rows = 2, .confidence = true};
  EXPECT_TRUE(refused(paper, sure));
  EXPECT_TRUE(refused(paper, told));
  EXPECT_TRUE(reconstruct(compact, sure));
  for (ReconstructSettings settings : {sure, told}) {
    settings.strategy = DenseStrategy::masks;
    EXPECT_TRUE(refused(compact, settings));
    settings.strategy = DenseStrategy::best;
    EXPECT_TRUE(reconstruct(paper, settings));
  }
}

TEST(Reconstruct, AsksTheFieldThatIsGiven) {
  const DecodedScan scan = decoded(Profile::compact);
  const auto box = std::make_shared<BoxScene>(false);
  ReconstructSettings settings{.rows = 2};
  settings.field = test::exact_scan(box, test::small_sensor()).field;
  const Cloud cloud = reconstruct(scan, settings).value();
  ASSERT_GT(cloud.size(), 10'000u);
  for (const Vec3& p : cloud.positions) {
    Hit hit;
    box->cast({}, p * (1 / norm(p)), hit);
    ASSERT_NEAR(norm(p), hit.range_m, 1e-9);
  }
  // One made once says what one made anew says.
  settings.field = continuous_field(scan);
  EXPECT_EQ(reconstruct(scan, settings)->positions, reconstruct(scan, {.rows = 2})->positions);
}

TEST(Reconstruct, RefusesFactorsBeyondTheirBounds) {
  const DecodedScan scan = decoded(Profile::compact);
  for (const double bad : {kLeastFactor / 2, kMostFactor * 2}) {
    EXPECT_EQ(reconstruct(scan, {.rows = bad}).error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(reconstruct_mesh(scan, {.columns = bad}).error().code, ErrorCode::invalid_argument);
  }
  EXPECT_TRUE(reconstruct(scan, {.rows = kLeastFactor, .columns = kLeastFactor}));
}

}  // namespace
}  // namespace curlidar
