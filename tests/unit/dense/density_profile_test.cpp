// SPDX-License-Identifier: BSD-3-Clause
#include "dense/density_profile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>

namespace curlidar {
namespace {

using testing::HasSubstr;

ObliviousTrees some_trees(std::size_t features) {
  ObliviousTrees trees;
  trees.cuts = {{-1.5f, .1f, 3e-7f + 1}, {}, {0}};
  trees.cuts.resize(features);
  trees.depth = 3;
  trees.splits = {{0, 1}, {2, 0}, {0, 2}, {1, 0}, {0, 0}, {2, 0}};
  for (int i = 0; i < 16; ++i) trees.leaves.push_back(static_cast<std::int16_t>(i * 2000 - 16000));
  trees.base = -1.0 / 3;
  trees.unit = 6.4e-5;
  return trees;
}

DensityProfile some_profile() {
  DensityProfile profile;
  profile.name = "a \"quoted\" name";
  profile.description = "two\nlines";
  profile.rows = 3;
  profile.given_first = 0;
  profile.given_every = 2;
  profile.elevation_mdeg = profile.return_permille = RangeTable(3);
  profile.given_return_permille = profile.bias_mm = RangeTable(3);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t bin = 0; bin < RangeTable::kBins; ++bin) {
      const auto number = static_cast<std::int16_t>(row * 100 + bin);
      profile.elevation_mdeg.row(row)[bin] = static_cast<std::int16_t>(number - 1500);
      profile.return_permille.row(row)[bin] = number;
      profile.bias_mm.row(row)[bin] = static_cast<std::int16_t>(-number);
    }
  }
  profile.returns = some_trees(kRowFeatures);
  profile.confidence = some_trees(kPlainFeatures);
  profile.row_confidence = some_trees(kRowFeatures);
  return profile;
}

std::string why_not(const std::string& text) {
  const Result<DensityProfile> profile = parse_density_profile(text, "here");
  return profile ? "" : profile.error().message;
}

TEST(RangeTable, BinsAreEvenInInverseRange) {
  EXPECT_EQ(RangeTable::bin(500), 0u);
  EXPECT_EQ(RangeTable::bin(192), 1u);
  EXPECT_EQ(RangeTable::bin(19.2), 10u);
  EXPECT_EQ(RangeTable::bin(3.01), 63u);
  EXPECT_EQ(RangeTable::bin(1e-9), 63u);
}

TEST(DensityProfile, ItsTextSaysItAll) {
  const DensityProfile profile = some_profile();
  ASSERT_TRUE(validate(profile));
  const std::string text = density_profile_text(profile);
  const Result<DensityProfile> read = parse_density_profile(text, "text");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, profile);
  EXPECT_EQ(density_profile_text(*read), text);
}

TEST(DensityProfile, WithoutTablesSaysNothing) {
  const Result<DensityProfile> read = parse_density_profile("name = \"x\"", "text");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->rows, 0u);
  EXPECT_EQ(read->return_share(7, 10), 1);
  EXPECT_EQ(read->bias_m(7, 10), 0);
}

TEST(DensityProfile, TellsNumbersInTheirUnits) {
  const DensityProfile profile = some_profile();
  EXPECT_NEAR(profile.elevation(1, 19.2), (-1500 + 110) * 1.7453292519943e-5, 1e-12);
  EXPECT_DOUBLE_EQ(profile.return_share(2, 500), .2);
  EXPECT_DOUBLE_EQ(profile.bias_m(1, 192), -.101);
  EXPECT_TRUE(profile.is_given(2));
  EXPECT_FALSE(profile.is_given(1));
}

TEST(DensityProfile, MistakesAreNamedWithTheirLine) {
  EXPECT_THAT(why_not("name = \"x\"\nrows = -1"), HasSubstr("here, line 2: rows"));
  EXPECT_THAT(why_not("\n\ncolour = 1"), HasSubstr("line 3: unknown key \"colour\""));
  EXPECT_THAT(why_not("rows = 2\n[tables]\nbias_mm = [[1]]"), HasSubstr("1 rows, the profile 2"));
  EXPECT_THAT(why_not("rows = 1\n[tables]\nbias_mm = [[1,\n70000]]"), HasSubstr("line 4: bias_mm"));
  EXPECT_THAT(why_not("rows = 1\n[tables]\nbias_mm = [[]]"), HasSubstr("row 0"));
  EXPECT_THAT(why_not("rows = 1\n[tables]\nreturn_permille = [[1001]]"), HasSubstr("1001"));
  EXPECT_THAT(why_not("[trees.returns]\ndepth = 2\nbase = 0.0"), HasSubstr("unit is missing"));
  EXPECT_THAT(why_not("[trees.returns]\ndepth = 1\nbase = 0\nunit = 1\ncuts = [[0]]\n"
                      "splits = [[1, 0]]\nleaves = [[1, 2]]"),
              HasSubstr("feature 1 of 1"));
  EXPECT_THAT(why_not("[trees.returns]\ndepth = 1\nbase = 0\nunit = 1\ncuts = [[0]]\n"
                      "splits = [[0, 0]]\nleaves = [[1]]"),
              HasSubstr("2 leaves, not 1"));
  EXPECT_THAT(why_not("[trees.returns]\ndepth = 1\nbase = 0\nunit = 1\ncuts = [[1e300]]\n"),
              HasSubstr("line 5: cuts"));
  EXPECT_THAT(why_not("[trees.confidence]\ndepth = 1\nbase = 0\nunit = 1\ncuts = [[0]]\n"
                      "splits = [[0, 0]]\nleaves = [[1, 2]]"),
              HasSubstr("features are meant"));
  EXPECT_THAT(why_not("[trees.wisdom]\ndepth = 1"), HasSubstr("unknown key \"wisdom\""));
  EXPECT_THAT(why_not("rows = 1\n[tables]\nelevation_mdeg = [[1]]\nbias_mm = [[1001]]"),
              HasSubstr("bias_mm, row 0: 1001 is not in -1000 .. 1000"));
  EXPECT_THAT(why_not("rows = 2"), HasSubstr("rows need elevations"));
  EXPECT_THAT(why_not("[trees.confidence]\ndepth = 1\nbase = 1e7\nunit = 1\ncuts = [[0]]\n"
                      "splits = [[0, 0]]\nleaves = [[1, 2]]"),
              HasSubstr("base and unit"));
  EXPECT_THAT(why_not("trees = 7"), HasSubstr("trees must be a table"));
  EXPECT_THAT(why_not("[="), HasSubstr("not TOML"));
}

TEST(DensityProfile, DamagedTextIsReadAsSomethingValidOrRefused) {
  const std::string text = density_profile_text(some_profile());
  std::size_t refused = 0;
  for (std::size_t i = 0; i < text.size(); i += 7) {
    std::string damaged = text;
    damaged[i] = "9-[]\"x,.="[i / 7 % 9];
    for (const std::string& tried : {damaged, text.substr(0, i)}) {
      const Result<DensityProfile> read = parse_density_profile(tried, "text");
      if (read) {
        EXPECT_EQ(
            density_profile_text(*parse_density_profile(density_profile_text(*read), "again")),
            density_profile_text(*read))
            << i;
      } else {
        ++refused;
        EXPECT_THAT(read.error().message, testing::StartsWith("text, line ")) << i;
      }
    }
  }
  EXPECT_GT(refused, text.size() / 20);
}

TEST(DensityProfile, TreesOfRowsNeedRows) {
  for (ObliviousTrees DensityProfile::*trees :
       {&DensityProfile::returns, &DensityProfile::residual, &DensityProfile::row_confidence}) {
    DensityProfile profile;
    profile.*trees = some_trees(kRowFeatures);
    const Status status = validate(profile);
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("trees of rows need rows"));
  }
}

TEST(DensityProfile, TheGenericOneTellsConfidence) {
  EXPECT_EQ(generic_confidence().features(), kPlainFeatures);
  EXPECT_GT(generic_confidence().trees(), 0u);
}

TEST(DensityProfile, FilesAreReadUpToALimit) {
  const std::string path = testing::TempDir() + "density_profile_test.toml";
  std::ofstream(path) << density_profile_text(some_profile());
  const auto read = load_density_profile(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(**read, some_profile());
  std::ofstream(path) << std::string((4u << 20) + 1, ' ');
  const auto large = load_density_profile(path);
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, ErrorCode::limit_exceeded);
  std::remove(path.c_str());
  const auto gone = load_density_profile(path);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::not_found);
}

TEST(DensityProfile, BuiltInOnesCanBeRead) {
  for (const std::string& name : builtin_density_names()) {
    const Result<DensityProfile> profile = builtin_density_profile(name);
    ASSERT_TRUE(profile) << profile.error().message;
    EXPECT_EQ(profile->name, name);
  }
  const Result<DensityProfile> unknown = builtin_density_profile("nothing");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("generic"));
}

}  // namespace
}  // namespace curlidar
