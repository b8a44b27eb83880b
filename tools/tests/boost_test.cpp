// SPDX-License-Identifier: BSD-3-Clause
#include "density/boost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace curlidar::density {
namespace {

/// Samples of three features in [0, 1), of which the last says nothing.
template <class Wanted>
Samples samples_of(std::size_t count, unsigned seed, const Wanted& wanted) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<float>(random() % 4096) / 4096; };
  Samples samples;
  samples.values.resize(3);
  for (std::size_t i = 0; i < count; ++i) {
    const float a = uniform(), b = uniform();
    samples.values[0].push_back(a);
    samples.values[1].push_back(b);
    samples.values[2].push_back(uniform());
    samples.wanted.push_back(wanted(a, b, uniform()));
    samples.weight.push_back(1);
  }
  return samples;
}

std::vector<float> values_of(const Samples& samples, std::size_t i) {
  return {samples.values[0][i], samples.values[1][i], samples.values[2][i]};
}

/// The probability of a one: a step of either feature, not their sum.
double share_of_ones(double a, double b) {
  return (a > .5) != (b > .25) ? .9 : .2;
}
float drawn(float a, float b, float luck) {
  return luck < share_of_ones(a, b) ? 1.f : 0.f;
}

TEST(Boost, LearnsProbabilities) {
  const Samples samples = samples_of(20000, 1, drawn), others = samples_of(500, 2, drawn);
  const ObliviousTrees trees = boost(samples, {.trees = 30, .depth = 3});
  ASSERT_TRUE(validate(trees));
  double error = 0;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const std::vector<float> values = values_of(others, i);
    error += std::abs(probability_of(trees(values)) - share_of_ones(values[0], values[1]));
  }
  EXPECT_LT(error / 500, .03);
}

TEST(Boost, LearnsMediansWhateverTheOutliers) {
  const auto wanted = [](float a, float b, float luck) {
    return luck < .2f ? 1000.f : (a > .3f ? 2.f : -1.f) + b;
  };
  const Samples samples = samples_of(20000, 3, wanted), others = samples_of(300, 4, wanted);
  const ObliviousTrees trees =
      boost(samples, {.loss = Loss::absolute, .trees = 60, .depth = 4, .rate = .3});
  double error = 0;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const std::vector<float> values = values_of(others, i);
    error += std::abs(trees(values) - wanted(values[0], values[1], .5f));
  }
  // A fifth of outliers on one side moves the median of what is spread by a few cuts of b.
  EXPECT_LT(error / 300, .08);
}

TEST(Boost, WeighsSamples) {
  Samples samples = samples_of(4000, 5, [](float, float, float luck) { return luck < .5f; });
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples.weight[i] = samples.wanted[i] > 0 ? 3 : 1;
  const ObliviousTrees trees = boost(samples, {.trees = 3, .depth = 1, .damping = 1e9});
  EXPECT_NEAR(probability_of(trees(std::vector<float>{.5f, .5f, .5f})), .75, .01);
}

TEST(Boost, ThreadsChangeNothing) {
  const Samples samples = samples_of(3000, 6, drawn);
  EXPECT_EQ(boost(samples, {.trees = 5}, 1), boost(samples, {.trees = 5}, 3));
}

}  // namespace
}  // namespace curlidar::density
