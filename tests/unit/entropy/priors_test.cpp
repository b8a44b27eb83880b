// SPDX-License-Identifier: BSD-3-Clause
#include "entropy/priors.hpp"

#include <array>

#include <gtest/gtest.h>

namespace curlidar {
namespace {

TEST(Priors, SetProbabilitiesAndVisits) {
  std::array<BitModel, 4> models;
  ASSERT_TRUE(apply_priors("# split\n0000 2a03\nd601\n", models));
  EXPECT_EQ(models[0].probability, 32768);
  EXPECT_EQ(models[1].probability, squash(42 * 24));
  EXPECT_EQ(models[1].visits, 3);
  EXPECT_EQ(models[2].probability, squash(-42 * 24));
  EXPECT_EQ(models[3].visits, 0);
}

TEST(Priors, RefuseOtherTexts) {
  std::array<BitModel, 2> models;
  EXPECT_FALSE(apply_priors("0000 00", models));
  EXPECT_FALSE(apply_priors("0000 00xx", models));
  EXPECT_FALSE(apply_priors("0000 0000 0000", models));
  EXPECT_TRUE(apply_priors("", models));
  EXPECT_TRUE(apply_priors("0000 0000 \n# no more", models));
}

TEST(Priors, SetWeights) {
  std::array<std::int32_t, 2> weights{};
  ASSERT_TRUE(apply_weight_priors("1000 f800", weights));
  EXPECT_EQ(weights[0], 65536);
  EXPECT_EQ(weights[1], -32768);
}

}  // namespace
}  // namespace curlidar
