// SPDX-License-Identifier: BSD-3-Clause
#include "entropy/range_coder.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "entropy/model.hpp"

namespace curlidar {
namespace {

struct Decision {
  std::uint32_t probability;
  bool bit;
};

std::vector<Decision> random_decisions(unsigned seed, std::size_t count) {
  std::mt19937 random(seed);
  std::vector<Decision> out(count);
  for (Decision& d : out) {
    const std::uint32_t kind = random() % 4;
    d.probability = kind == 0   ? kMinProbability
                    : kind == 1 ? 65536 - kMinProbability
                                : static_cast<std::uint32_t>(
                                      kMinProbability + random() % (65537 - 2 * kMinProbability));
    d.bit = random() % 65536u < d.probability;
    if (random() % 50 == 0) d.bit = !d.bit;
  }
  return out;
}

TEST(RangeCoder, GivesBackWhatWasWritten) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const auto decisions = random_decisions(seed, seed < 100 ? seed : 20 * seed);
    RangeEncoder encoder;
    for (const Decision& d : decisions) encoder.code(d.probability, d.bit);
    const auto bytes = std::move(encoder).finish();
    RangeDecoder decoder(bytes);
    for (const Decision& d : decisions) ASSERT_EQ(decoder.code(d.probability), d.bit);
    EXPECT_FALSE(decoder.exhausted());
    EXPECT_TRUE(decoder.finished());
  }
}

TEST(RangeCoder, CostsLittleMoreThanTheEntropy) {
  const auto decisions = random_decisions(7, 100000);
  RangeEncoder encoder;
  CostCounter counter;
  double bits = 0;
  for (const Decision& d : decisions) {
    encoder.code(d.probability, d.bit);
    counter.code(d.probability, d.bit);
    bits -= std::log2((d.bit ? d.probability : 65536 - d.probability) / 65536.0);
  }
  const auto bytes = std::move(encoder).finish();
  EXPECT_LT(8.0 * static_cast<double>(bytes.size()), 1.002 * bits + 16);
  EXPECT_NEAR(static_cast<double>(counter.cost()) / 256, bits, 0.01 * bits);
}

TEST(RangeCoder, AnEmptyStreamHasNoBytes) {
  EXPECT_TRUE(RangeEncoder().finish().empty());
}

TEST(RangeCoder, TellsWhenTheBytesAreUsedUp) {
  const std::vector<std::byte> bytes(3, std::byte{0x5a});
  RangeDecoder decoder(bytes);
  EXPECT_FALSE(decoder.exhausted());
  for (int i = 0; i < 80; ++i) decoder.code(32768);
  EXPECT_TRUE(decoder.exhausted());
}

TEST(Logistic, TablesFollowTheirFormulas) {
  for (int x = -kStretchLimit; x <= kStretchLimit; ++x) {
    const double exact = 65536 / (1 + std::exp(-x / 256.0));
    EXPECT_NEAR(squash(x), std::clamp(exact, 32.0, 65504.0), 520) << x;  // linear between knots
  }
  for (std::uint32_t p = 64; p < 65472; p += 16) {
    EXPECT_NEAR(squash(stretch(p)), p + 8, 130) << p;
    EXPECT_NEAR(bit_cost(p, true) / 256.0, -std::log2((p + 8) / 65536.0), 0.005) << p;
    EXPECT_EQ(bit_cost(p, false), bit_cost(65535 - p, true));
  }
}

TEST(BitModel, LearnsTheShareOfOnes) {
  std::mt19937 random(3);
  BitModel model;
  for (int i = 0; i < 5000; ++i) model.update(random() % 10 == 0, 255);
  EXPECT_NEAR(model.probability / 65536.0, 0.1, 0.04);
}

TEST(Mix, PrefersTheModelThatKnows) {
  std::mt19937 random(5);
  std::array<BitModel, 2> knowing;
  BitModel ignorant;
  MixWeights<2> weights;
  CostCounter mixed;
  for (int i = 0; i < 20000; ++i) {
    const bool hint = random() % 2 != 0;
    const bool bit = (random() % 20 == 0) != hint;
    code_bit(mixed, std::array<BitModel*, 2>{&knowing[hint], &ignorant}, weights, 20, 255, bit);
  }
  const double entropy = -(0.05 * std::log2(0.05) + 0.95 * std::log2(0.95));
  EXPECT_LT(static_cast<double>(mixed.cost()) / 256 / 20000, 1.1 * entropy);
}

}  // namespace
}  // namespace curlidar
