// SPDX-License-Identifier: BSD-3-Clause
#include "compact/residual_coder.hpp"

#include "compact/residual_predictor.hpp"
#include "compact/residual_symbols.hpp"
#include "entropy/embedded_priors.hpp"
#include "entropy/priors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

namespace curlidar::compact {
namespace {

/// A made-up segment: walls seen with noise, holes in the mask, a field that is off by a little.
struct Scene {
  std::size_t rows, columns;
  std::vector<std::uint8_t> occupied, coded;
  std::vector<std::int32_t> field, surface, ranges;

  Scene(std::size_t row_count, std::size_t column_count, std::uint64_t seed)
      : rows(row_count), columns(column_count) {
    std::mt19937_64 random(seed);
    const auto below = [&](std::int32_t n) {
      return static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(n));
    };
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t column = 0; column < columns; ++column) {
        const auto wall = static_cast<std::int32_t>(column / 16);
        const std::int32_t distance = 65536 * (8 + wall % 5) + 900 * static_cast<std::int32_t>(row);
        const std::int32_t tilt = 40 * static_cast<std::int32_t>(column % 16);
        const std::int32_t noise = below(700) + below(700) - 700;
        occupied.push_back(below(10) != 0);
        coded.push_back(wall % 3 != 1);
        surface.push_back(wall);
        field.push_back(distance);
        ranges.push_back(std::max(1, distance + tilt + noise + (below(50) == 0 ? 200000 : 0)));
      }
    }
  }
  ResidualSegment segment() const { return {rows, columns, occupied, coded, field, surface}; }
  std::size_t cells() const { return rows * columns; }
};

std::vector<std::byte> random_bytes(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::byte> bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() & 255);
  return bytes;
}

class ResidualSteps : public testing::TestWithParam<std::int32_t> {};

TEST_P(ResidualSteps, DecodesToWhatTheEncoderSaysWithinHalfAStep) {
  const std::int32_t step = GetParam();
  const Scene scene(24, 96, 1);
  std::vector<std::int32_t> told(scene.cells()), decoded(scene.cells());
  const auto bytes = encode_residual(scene.segment(), scene.ranges, {step}, {}, told);
  EXPECT_EQ(decode_residual(bytes, scene.segment(), {step}, decoded), scene.rows);
  EXPECT_EQ(decoded, told);
  for (std::size_t i = 0; i < scene.cells(); ++i) {
    if (!scene.occupied[i]) {
      EXPECT_EQ(decoded[i], 0);
    } else if (!scene.coded[i]) {
      EXPECT_EQ(decoded[i], scene.field[i]);
    } else {
      EXPECT_LE(2 * std::abs(decoded[i] - scene.ranges[i]), step) << "cell " << i;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Steps, ResidualSteps,
                         testing::Values(1, 2, 131, 524, 1311, 6554, 65536, 1 << 24));

TEST(ResidualCoder, RangesOnALatticeDecodeExactly) {
  constexpr std::uint64_t two_mm = 8589935;  // 1/2^32 m
  Scene scene(24, 96, 9);
  for (std::int32_t& range : scene.ranges) {
    const std::uint64_t multiple =
        ((static_cast<std::uint64_t>(range) << 16) + two_mm / 2) / two_mm;
    range = static_cast<std::int32_t>((multiple * two_mm + 32768) >> 16);
  }
  const auto largest_error = [&](const ResidualLevels& levels) {
    std::vector<std::int32_t> told(scene.cells()), decoded(scene.cells());
    const auto bytes = encode_residual(scene.segment(), scene.ranges, levels, {}, told);
    EXPECT_EQ(decode_residual(bytes, scene.segment(), levels, decoded), scene.rows);
    EXPECT_EQ(decoded, told);
    std::int32_t largest = 0;
    for (std::size_t i = 0; i < scene.cells(); ++i) {
      if (!scene.occupied[i] || !scene.coded[i]) continue;
      largest = std::max(largest, std::abs(decoded[i] - scene.ranges[i]));
    }
    return largest;
  };
  EXPECT_EQ(largest_error({.step = 1, .lattice_q32 = two_mm}), 0);
  EXPECT_LE(largest_error({.step = 1, .lattice_q32 = 3 * two_mm}), 132);
  EXPECT_LE(largest_error({.step = 1, .lattice_q32 = std::uint64_t{1} << 40}), 1 << 23);
}

TEST(ResidualCoder, LevelsBeyondTheLimitsAreTakenAsTheNearestInside) {
  const Scene scene(4, 16, 10);
  const auto bytes = random_bytes(400, 11);
  const auto decode = [&](const ResidualLevels& levels) {
    std::vector<std::int32_t> decoded(scene.cells());
    decode_residual(bytes, scene.segment(), levels, decoded);
    return decoded;
  };
  EXPECT_EQ(decode({.step = 0}), decode({.step = 1}));
  EXPECT_EQ(decode({.step = -5}), decode({.step = 1}));
  EXPECT_EQ(decode({.step = 1 << 30}), decode({.step = 1 << 24}));
  EXPECT_EQ(decode({.step = 1, .lattice_q32 = 1}), decode({.step = 1, .lattice_q32 = 1 << 16}));
  EXPECT_EQ(decode({.step = 1, .lattice_q32 = ~std::uint64_t{0}}),
            decode({.step = 1, .lattice_q32 = std::uint64_t{1} << 40}));
}

TEST(ResidualCoder, TablesOfPriorsFillTheModels) {
  ResidualSymbols symbols(100);
  ResidualPredictor predictor(8, 100);
  EXPECT_TRUE(apply_priors(embedded_priors("residual"), symbols.models()));
  EXPECT_TRUE(apply_weight_priors(embedded_priors("residual_mix"), symbols.weights()));
  EXPECT_TRUE(apply_weight_priors(embedded_priors("residual_filter"), predictor.filter_weights()));
  // The last of each is set, so none is too short.
  std::vector<std::int32_t> weights(symbols.weights().size() - 1);
  EXPECT_FALSE(apply_weight_priors(embedded_priors("residual_mix"), weights));
  EXPECT_FALSE(apply_weight_priors(embedded_priors("residual_filter"),
                                   predictor.filter_weights().first(16 * 11 - 1)));
  EXPECT_FALSE(apply_priors(embedded_priors("residual"),
                            symbols.models().first(symbols.models().size() - 1)));
}

TEST(ResidualCoder, ABitsWorthTradesErrorForBytes) {
  const Scene scene(32, 128, 2);
  const std::int32_t step = 1311;
  std::vector<std::int32_t> exact(scene.cells()), cheap(scene.cells());
  const auto full = encode_residual(scene.segment(), scene.ranges, {step}, {}, exact);
  const auto less = encode_residual(scene.segment(), scene.ranges, {step}, {static_cast<std::uint32_t>(44 * step)}, cheap);
  EXPECT_LT(less.size() * 10, full.size() * 9);
  std::int64_t exact_error = 0, cheap_error = 0;
  for (std::size_t i = 0; i < scene.cells(); ++i) {
    if (!scene.occupied[i] || !scene.coded[i]) continue;
    exact_error += std::abs(exact[i] - scene.ranges[i]);
    cheap_error += std::abs(cheap[i] - scene.ranges[i]);
  }
  EXPECT_GT(cheap_error, exact_error);
  EXPECT_LT(cheap_error, 2 * exact_error);
}

TEST(ResidualCoder, NoiseCostsItsEntropy) {
  // Triangular noise on +-700 has 10.2 bits, 3.1 of them above a step of 131; the rest is for
  // outliers and for predicting from noisy neighbours.
  const Scene scene(64, 512, 3);
  std::vector<std::int32_t> decoded(scene.cells());
  const auto bytes = encode_residual(scene.segment(), scene.ranges, {131}, {}, decoded);
  std::size_t coded = 0;
  for (std::size_t i = 0; i < scene.cells(); ++i) coded += scene.occupied[i] && scene.coded[i];
  const double bits = 8.0 * static_cast<double>(bytes.size()) / static_cast<double>(coded);
  EXPECT_LT(bits, 4.0);
  EXPECT_GT(bits, 3.1);
}

TEST(ResidualCoder, NothingCodedTakesNoBytes) {
  Scene scene(8, 16, 4);
  std::fill(scene.coded.begin(), scene.coded.end(), std::uint8_t{0});
  std::vector<std::int32_t> decoded(scene.cells());
  EXPECT_TRUE(encode_residual(scene.segment(), scene.ranges, {100}, {}, decoded).empty());
  EXPECT_EQ(decode_residual({}, scene.segment(), {100}, decoded), scene.rows);

  EXPECT_TRUE(encode_residual({}, {}, {100}, {}, {}).empty());
  EXPECT_EQ(decode_residual({}, {}, {100}, {}), 0u);
}

TEST(ResidualCoder, ExtremeRangesAndFieldsSurvive) {
  Scene scene(12, 40, 5);
  std::mt19937_64 random(6);
  for (std::size_t i = 0; i < scene.cells(); ++i) {
    scene.ranges[i] = random() % 2 ? kMaxRangeQ16 : 1;
    scene.field[i] = static_cast<std::int32_t>(random());
  }
  for (const std::int32_t step : {1, 3, 1 << 24}) {
    std::vector<std::int32_t> told(scene.cells()), decoded(scene.cells());
    const auto bytes = encode_residual(scene.segment(), scene.ranges, {step}, {}, told);
    EXPECT_EQ(decode_residual(bytes, scene.segment(), {step}, decoded), scene.rows);
    EXPECT_EQ(decoded, told);
    for (std::size_t i = 0; i < scene.cells(); ++i) {
      if (!scene.occupied[i] || !scene.coded[i]) continue;
      EXPECT_LE(2 * std::int64_t{std::abs(decoded[i] - scene.ranges[i])}, step);
    }
  }
}

TEST(ResidualCoder, ACutStreamGivesItsCompleteRows) {
  const Scene scene(10, 64, 7);
  std::vector<std::int32_t> told(scene.cells()), decoded(scene.cells());
  const auto bytes = encode_residual(scene.segment(), scene.ranges, {66}, {}, told);
  std::size_t before = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::size_t rows =
        decode_residual(ByteSpan(bytes).first(size), scene.segment(), {66}, decoded, /*cut=*/true);
    ASSERT_GE(rows, before);
    before = rows;
    for (std::size_t i = 0; i < scene.cells(); ++i) {
      const bool complete = i < rows * scene.columns;
      ASSERT_EQ(decoded[i], complete            ? told[i]
                            : scene.occupied[i] ? scene.field[i]
                                                : 0)
          << "cut to " << size << ", cell " << i;
    }
    // Found out without being told, but for the last bytes.
    if (size + 8 < bytes.size()) {
      ASSERT_EQ(decode_residual(ByteSpan(bytes).first(size), scene.segment(), {66}, decoded), rows);
    }
  }
  EXPECT_GE(before, scene.rows - 2);
}

TEST(ResidualCoder, AnyBytesDecodeToRangesInsideTheLimits) {
  const Scene scene(16, 64, 8);
  std::vector<std::int32_t> decoded(scene.cells());
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const auto bytes = random_bytes(static_cast<std::size_t>(seed * 40), seed);
    for (const std::int32_t step : {1, 500, 1 << 24}) {
      EXPECT_LE(decode_residual(bytes, scene.segment(), {step}, decoded), scene.rows);
      for (std::size_t i = 0; i < scene.cells(); ++i) {
        ASSERT_EQ(decoded[i] > 0, scene.occupied[i] != 0);
        ASSERT_LE(decoded[i], kMaxRangeQ16);
      }
    }
  }
  const std::vector<std::byte> ones(4000, std::byte{0xff});
  EXPECT_LE(decode_residual(ones, scene.segment(), {1}, decoded), scene.rows);
}

}  // namespace
}  // namespace curlidar::compact
