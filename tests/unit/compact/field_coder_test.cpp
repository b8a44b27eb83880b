// SPDX-License-Identifier: BSD-3-Clause
#include <random>

#include <gtest/gtest.h>

#include "compact/field_encoder.hpp"
#include "entropy/embedded_priors.hpp"
#include "entropy/priors.hpp"

namespace curlidar::compact {
namespace {

/// A wall, a floor and a few posts, seen by rings one degree apart; some cells empty.
struct Scene {
  Geometry geometry;
  std::vector<std::uint8_t> occupied;
  std::vector<std::int32_t> ranges;
};

Scene make_scene(std::uint32_t rows, std::uint32_t columns, unsigned seed) {
  std::vector<std::int32_t> elevations;
  for (std::uint32_t i = 0; i < rows; ++i) {
    elevations.push_back((static_cast<std::int32_t>(rows) / 2 - static_cast<std::int32_t>(i)) *
                         11930465);
  }
  Scene scene{Geometry(elevations, columns, 0, columns), {}, {}};
  std::mt19937 random(seed);
  for (std::size_t p = 0; p < scene.geometry.cells(); ++p) {
    const Direction& d = scene.geometry.directions()[p];
    // The plane x = 8 m, the floor z = -1.5 m, and posts at 4 m every 16 columns.
    std::int64_t range = 30 * kRangeUnit;
    if (d.x > 0) range = std::min<std::int64_t>(range, (std::int64_t{8 * kRangeUnit} << 22) / d.x);
    if (d.z < 0) {
      range = std::min<std::int64_t>(range, -(std::int64_t{3 * kRangeUnit / 2} << 22) / d.z);
    }
    if (p % columns % 16 == 5) range = std::min<std::int64_t>(range, 4 * kRangeUnit);
    range += static_cast<std::int64_t>(random() % 1311) - 655;
    scene.occupied.push_back(random() % 10 != 0 ? 1 : 0);
    scene.ranges.push_back(scene.occupied.back() ? static_cast<std::int32_t>(range) : 0);
  }
  return scene;
}

SearchSettings settings_for(std::int32_t step) {
  SearchSettings settings;
  settings.lambda = std::max(step * 17 / 100, 1);
  return settings;
}

double mean_error(const Scene& scene, const FieldState& state) {
  double sum = 0, count = 0;
  for (std::size_t p = 0; p < scene.ranges.size(); ++p) {
    if (!scene.occupied[p]) continue;
    sum += std::abs(scene.ranges[p] - state.range[p]) / static_cast<double>(kRangeUnit);
    ++count;
  }
  return sum / count;
}

TEST(FieldCoder, DecodesWhatTheEncoderSaw) {
  for (const std::uint32_t rows : {1u, 7u, 16u, 40u}) {
    const Scene scene = make_scene(rows, 90, rows);
    for (const std::int32_t step : {kRangeUnit, kRangeUnit / 10, kRangeUnit / 100}) {
      const FieldSettings settings{step, 4, 8};
      FieldState coded(scene.geometry, scene.occupied, settings);
      const EncodedField field = encode_field(coded, scene.ranges, settings_for(step));
      FieldState decoded(scene.geometry, scene.occupied, settings);
      const DecodedField read = decode_field(decoded, field.bytes);
      EXPECT_EQ(read.complete_roots, roots_of(scene.geometry, settings).size());
      EXPECT_EQ(decoded.surface, coded.surface);
      for (std::size_t p = 0; p < scene.ranges.size(); ++p) {
        if (scene.occupied[p]) {
          ASSERT_EQ(decoded.range[p], coded.range[p]) << p;
        }
      }
    }
  }
}

TEST(FieldCoder, FinerStepsGiveSmallerErrorsForMoreBits) {
  const Scene scene = make_scene(32, 128, 1);
  double error = 1e9;
  std::size_t size = 0;
  for (const std::int32_t step : {kRangeUnit, kRangeUnit / 4, kRangeUnit / 16, kRangeUnit / 64}) {
    FieldState state(scene.geometry, scene.occupied, {step, 4, 8});
    const EncodedField field = encode_field(state, scene.ranges, settings_for(step));
    EXPECT_LT(mean_error(scene, state), error);
    EXPECT_GT(field.bytes.size(), size);
    error = mean_error(scene, state);
    size = field.bytes.size();
  }
  EXPECT_LT(error, 0.01);
}

TEST(FieldCoder, OnePlaneIsOneSurfaceInherited) {
  Scene scene = make_scene(32, 64, 2);
  for (std::size_t p = 0; p < scene.ranges.size(); ++p) {
    const Direction& d = scene.geometry.directions()[p];
    // A slanted plane that every direction meets: n . d = .1 + .02 d.y + .03 d.z.
    const std::int64_t inverse = (std::int64_t{107374182} * (1 << 22) +
                                  std::int64_t{21474836} * d.y + std::int64_t{32212255} * d.z) >>
                                 22;
    scene.occupied[p] = d.x > 1 << 21 ? 1 : 0;
    scene.ranges[p] =
        scene.occupied[p] ? static_cast<std::int32_t>((std::int64_t{1} << 46) / inverse) : 0;
  }
  FieldState state(scene.geometry, scene.occupied, {kRangeUnit / 20, 4, 8});
  const EncodedField field = encode_field(state, scene.ranges, settings_for(kRangeUnit / 20));
  EXPECT_LT(field.bytes.size(), 80u);
  EXPECT_LT(mean_error(scene, state), 0.02);
}

TEST(FieldCoder, CutBytesGiveTheRootsBeforeTheCut) {
  const Scene scene = make_scene(32, 128, 3);
  const FieldSettings settings{kRangeUnit / 10, 4, 8};
  FieldState whole(scene.geometry, scene.occupied, settings);
  const EncodedField field = encode_field(whole, scene.ranges, settings_for(settings.step));
  const std::vector<Block> roots = roots_of(scene.geometry, settings);
  std::size_t before = 0;
  for (std::size_t size = 0; size + 4 < field.bytes.size(); size += 7) {
    FieldState state(scene.geometry, scene.occupied, settings);
    const DecodedField read = decode_field(state, ByteSpan(field.bytes).first(size), false);
    EXPECT_GE(read.complete_roots, before);
    before = read.complete_roots;
  }
  EXPECT_GT(before, roots.size() / 2);
  EXPECT_LE(before, roots.size());
}

TEST(FieldCoder, AnyBytesDecodeToSomethingBounded) {
  const Scene scene = make_scene(24, 70, 4);
  std::mt19937 random(5);
  for (int round = 0; round < 60; ++round) {
    std::vector<std::byte> bytes(random() % 400);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    const std::int32_t step = round % 2 == 0 ? 1 : 1 << 24;
    FieldState state(scene.geometry, scene.occupied, {step, 1u + round % 5, 1});
    decode_field(state, bytes);
    EXPECT_LE(state.surfaces.size(), 2 * scene.geometry.cells());
    for (std::size_t p = 0; p < scene.ranges.size(); ++p) {
      if (state.surface[p] == kNoSurface) continue;
      ASSERT_GE(state.range[p], kMinRange);
      ASSERT_LE(state.range[p], kMaxRange);
    }
  }
}

TEST(FieldCoder, MostEffortFindsNoWorseThanLittle) {
  const Scene scene = make_scene(32, 128, 6);
  const auto cost = [&](const SearchSettings& settings) {
    FieldState state(scene.geometry, scene.occupied, {kRangeUnit / 10, 4, 8});
    const EncodedField field = encode_field(state, scene.ranges, settings);
    double errors = 0;
    for (std::size_t p = 0; p < scene.ranges.size(); ++p) {
      if (scene.occupied[p]) errors += std::abs(scene.ranges[p] - state.range[p]);
    }
    return errors / static_cast<double>(settings.lambda) +
           8.0 * static_cast<double>(field.bytes.size());
  };
  SearchSettings little = settings_for(kRangeUnit / 10);
  little.max_layers = 1;
  little.binary_below = 1;
  EXPECT_LT(cost(settings_for(kRangeUnit / 10)), cost(little));
}

TEST(Priors, EveryTableReadsWhole) {
  std::vector<BitModel> models(1 << 16);
  for (const char* name : {"field", "mask", "residual"}) {
    EXPECT_FALSE(embedded_priors(name).empty()) << name;
    EXPECT_TRUE(apply_priors(embedded_priors(name), models)) << name;
  }
  std::vector<std::int32_t> weights(1 << 16);
  for (const char* name : {"field_mix", "mask_mix", "residual_mix", "residual_filter"}) {
    EXPECT_FALSE(embedded_priors(name).empty()) << name;
    EXPECT_TRUE(apply_weight_priors(embedded_priors(name), weights)) << name;
  }
  models.resize(kFieldModels);
  EXPECT_TRUE(apply_priors(embedded_priors("field"), models));
  weights.resize(kFieldMixers * kFieldInputs);
  EXPECT_TRUE(apply_weight_priors(embedded_priors("field_mix"), weights));
}

}  // namespace
}  // namespace curlidar::compact
