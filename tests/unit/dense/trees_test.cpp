// SPDX-License-Identifier: BSD-3-Clause
#include "dense/trees.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace curlidar {
namespace {

/// Two features, two trees of two splits.
ObliviousTrees small_trees() {
  ObliviousTrees trees;
  trees.cuts = {{-1, 0, 2.5f}, {10}};
  trees.depth = 2;
  trees.splits = {{0, 0}, {1, 0}, {0, 2}, {0, 1}};
  trees.leaves = {1, 20, 300, 4000, -1, -2, -3, -4};
  trees.base = .5;
  trees.unit = .25;
  return trees;
}

/// What the trees say, told by comparing values with cuts, leaf by leaf.
double by_hand(const ObliviousTrees& trees, const std::vector<float>& values) {
  double sum = trees.base;
  for (std::size_t tree = 0; tree < trees.trees(); ++tree) {
    std::size_t leaf = 0;
    for (std::size_t i = 0; i < trees.depth; ++i) {
      const auto split = trees.splits[tree * trees.depth + i];
      const std::vector<float>& cuts = trees.cuts[split.feature];
      const bool above = split.level < cuts.size() && values[split.feature] > cuts[split.level];
      if (above) leaf += std::size_t{1} << i;
    }
    sum += trees.unit * trees.leaves[(tree << trees.depth) + leaf];
  }
  return sum;
}

TEST(Trees, AskTheirQuestions) {
  const ObliviousTrees trees = small_trees();
  ASSERT_TRUE(validate(trees));
  EXPECT_EQ(trees(std::vector<float>{-2, 0}), .5 + .25 * (1 - 1));
  EXPECT_EQ(trees(std::vector<float>{-.5f, 0}), .5 + .25 * (20 - 1));
  EXPECT_EQ(trees(std::vector<float>{1, 11}), .5 + .25 * (4000 - 3));
  EXPECT_EQ(trees(std::vector<float>{3, 11}), .5 + .25 * (4000 - 4));
}

TEST(Trees, ACutBelongsToTheLowerSide) {
  const ObliviousTrees trees = small_trees();
  std::vector<std::uint8_t> levels(2);
  trees.quantise(std::vector<float>{-1, 10}, levels);
  EXPECT_EQ(levels, (std::vector<std::uint8_t>{0, 0}));
  trees.quantise(std::vector<float>{std::nextafter(-1.f, 0.f), 10.5f}, levels);
  EXPECT_EQ(levels, (std::vector<std::uint8_t>{1, 1}));
}

TEST(Trees, WhatIsNoNumberLiesBelow) {
  const ObliviousTrees trees = small_trees();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(trees(std::vector<float>{nan, nan}), trees(std::vector<float>{-1e9f, -1e9f}));
}

TEST(Trees, AgreeWithComparingValuesByHand) {
  std::mt19937 random(5);
  const auto number = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  for (int round = 0; round < 50; ++round) {
    ObliviousTrees trees;
    trees.cuts.resize(static_cast<std::size_t>(number(1, 9)));
    for (std::vector<float>& cuts : trees.cuts) {
      float cut = -5;
      for (int i = number(0, 40); i > 0; --i)
        cuts.push_back(cut += static_cast<float>(number(1, 9)) * .1f);
    }
    trees.depth = static_cast<std::size_t>(number(1, 8));
    for (std::size_t tree = static_cast<std::size_t>(number(1, 6)); tree > 0; --tree) {
      for (std::size_t i = 0; i < trees.depth; ++i) {
        const int last = static_cast<int>(trees.cuts.size()) - 1;
        trees.splits.push_back(
            {static_cast<std::uint8_t>(number(0, last)), static_cast<std::uint8_t>(number(0, 50))});
      }
      for (std::size_t i = 0; i < std::size_t{1} << trees.depth; ++i) {
        trees.leaves.push_back(static_cast<std::int16_t>(number(-9000, 9000)));
      }
    }
    trees.base = number(-9, 9);
    trees.unit = .125;  // sums are exact
    ASSERT_TRUE(validate(trees));
    for (int i = 0; i < 20; ++i) {
      std::vector<float> values;
      for (std::size_t k = 0; k < trees.features(); ++k)
        values.push_back(static_cast<float>(number(-90, 90)) * .1f);
      EXPECT_EQ(trees(values), by_hand(trees, values));
    }
  }
}

TEST(Trees, ThatMakeNoSenseAreRefused) {
  const auto refused = [](void (*spoil)(ObliviousTrees&)) {
    ObliviousTrees trees = small_trees();
    spoil(trees);
    return !validate(trees);
  };
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.cuts.clear(); }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.cuts[0] = {1, 1}; }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.cuts[0] = {NAN}; }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.cuts[0].assign(256, 0); }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.depth = 0; }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.depth = 9; }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.splits.pop_back(); }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.splits.clear(); }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.splits[0].feature = 2; }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.leaves.pop_back(); }));
  EXPECT_TRUE(refused([](ObliviousTrees& t) { t.unit = INFINITY; }));
}

}  // namespace
}  // namespace curlidar
