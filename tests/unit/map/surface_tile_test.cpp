// SPDX-License-Identifier: BSD-3-Clause
#include "map/surface_tile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <thread>

#include "map/tile_points.hpp"
#include "support/surface_scenes.hpp"

namespace curlidar {
namespace {

using test::box_samples;
using test::plane_samples;
using test::sphere_samples;

constexpr double kSide = 16;

SurfaceSettings fine() {
  SurfaceSettings settings;
  settings.step_m = 0.02;
  settings.metres_per_bit = 0.01;
  settings.footprint_m = 0.125;
  return settings;
}

MapTile coded(const std::vector<MapSample>& samples, const SurfaceSettings& settings,
              std::uint32_t level = kAllLevels) {
  const auto bytes = encode_surface_tile(samples, settings, kSide);
  EXPECT_TRUE(bytes) << bytes.error().message;
  auto tile = decode_surface_tile(*bytes, {}, level);
  EXPECT_TRUE(tile) << tile.error().message;
  return *tile;
}

/// Mean distance of samples to the leaf above or below them, at most 1 m.
double mean_distance(const std::vector<MapSample>& samples, const MapTile& tile) {
  double sum = 0;
  for (const MapSample& sample : samples) sum += test::distance_to(tile, sample.position, 1.0);
  return sum / static_cast<double>(samples.size());
}

TEST(SurfaceTile, APlaneIsHardlyAnyBytes) {
  const auto samples = plane_samples(kSide, 0.01);
  const auto bytes = encode_surface_tile(samples, {}, kSide);
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_LT(bytes->size(), 40u);
  const MapTile tile = coded(samples, {});
  EXPECT_LT(mean_distance(samples, tile), 0.03);
  double area = 0;
  for (const MapLeaf& leaf : tile.leaves) {
    for (std::size_t k = 0; k < leaf.cells * leaf.cells; ++k) {
      area += tile.footprint[leaf.first_cell + k] * std::pow(leaf.size_m / leaf.cells, 2);
    }
  }
  EXPECT_NEAR(area, kSide * kSide, 0.1 * kSide * kSide);
}

TEST(SurfaceTile, BoxAndSphereLieWhereTheyAre) {
  for (const auto& samples : {box_samples(kSide), sphere_samples(kSide)}) {
    const MapTile tile = coded(samples, fine());
    EXPECT_LT(mean_distance(samples, tile), 0.02);
    const std::vector<MapSample> points = tile_points(tile, 0.1);
    for (std::size_t i = 0; i < points.size(); i += 97) {
      EXPECT_LT(test::distance_to(samples, points[i].position), 0.3);
    }
  }
}

TEST(SurfaceTile, ErrorFallsWithTheStepAndWithThePriceOfBits) {
  const auto samples = sphere_samples(kSide);
  double error = 1;
  std::size_t size = 0;
  for (const double scale : {4.0, 1.0, 0.25}) {
    SurfaceSettings settings = fine();
    settings.step_m *= scale;
    settings.metres_per_bit *= scale * scale;
    const double found = mean_distance(samples, coded(samples, settings));
    const std::size_t bytes = encode_surface_tile(samples, settings, kSide)->size();
    EXPECT_LT(found, error);
    EXPECT_GT(bytes, size);
    error = found;
    size = bytes;
  }
}

TEST(SurfaceTile, CurvesSaveBytesOnASphere) {
  const auto samples = sphere_samples(kSide);
  SurfaceSettings settings = fine();
  const std::size_t flat = encode_surface_tile(samples, settings, kSide)->size();
  const double flat_error = mean_distance(samples, coded(samples, settings));
  settings.curves = true;
  const std::size_t bent = encode_surface_tile(samples, settings, kSide)->size();
  EXPECT_LT(bent, flat);
  EXPECT_LT(mean_distance(samples, coded(samples, settings)), 1.1 * flat_error);
}

TEST(SurfaceTile, TheOrderOfSamplesDoesNotMatter) {
  auto samples = box_samples(kSide);
  SurfaceSettings settings;
  settings.intensity = true;
  settings.curves = true;
  const auto bytes = encode_surface_tile(samples, settings, kSide);
  ASSERT_TRUE(bytes);
  std::mt19937 random(7);
  std::shuffle(samples.begin(), samples.end(), random);
  EXPECT_EQ(*encode_surface_tile(samples, settings, kSide), *bytes);
  std::reverse(samples.begin(), samples.end());
  EXPECT_EQ(*encode_surface_tile(samples, settings, kSide), *bytes);
}

TEST(SurfaceTile, TilesCodedAtOnceAreThoseCodedAlone) {
  const auto box = box_samples(kSide), sphere = sphere_samples(kSide);
  const auto alone = encode_surface_tile(box, {}, kSide);
  Result<std::vector<std::byte>> a = Error{}, b = Error{};
  std::thread one([&] { a = encode_surface_tile(box, {}, kSide); });
  std::thread other([&] { b = encode_surface_tile(sphere, {}, kSide); });
  one.join();
  other.join();
  EXPECT_EQ(*a, *alone);
  EXPECT_EQ(*b, *encode_surface_tile(sphere, {}, kSide));
}

TEST(SurfaceTile, CoarserLevelsHaveFewerLeavesAndStayNear) {
  const auto samples = box_samples(kSide);
  std::size_t leaves = 1u << 30;
  for (const std::uint32_t level : {4u, 2u, 0u}) {
    const MapTile tile = coded(samples, fine(), level);
    for (const MapLeaf& leaf : tile.leaves) EXPECT_LE(leaf.level, level);
    EXPECT_LT(tile.leaves.size(), leaves);
    EXPECT_LT(mean_distance(samples, tile), 0.25 * 4 / (1 << level));
    leaves = tile.leaves.size();
  }
  EXPECT_GT(leaves, 0u);
}

TEST(SurfaceTile, ALevelOfAPlaneIsThePlane) {
  const auto samples = plane_samples(kSide, 0);
  for (const std::uint32_t level : {0u, 1u, 3u}) {
    EXPECT_LT(mean_distance(samples, coded(samples, fine(), level)), 0.02);
  }
}

TEST(SurfaceTile, IntensitiesComeBackWithinTheirStep) {
  auto samples = plane_samples(kSide, 0);
  for (MapSample& sample : samples)
    sample.intensity = sample.position.x < kSide / 2 ? 0.25f : 0.75f;
  SurfaceSettings settings;
  settings.intensity = true;
  const MapTile tile = coded(samples, settings);
  ASSERT_FALSE(tile.leaves.empty());
  for (const MapLeaf& leaf : tile.leaves) {
    EXPECT_NEAR(leaf.intensity, leaf.centre.x < kSide / 2 ? 0.25f : 0.75f, 0.02f);
  }
  settings.intensity = false;
  for (const MapLeaf& leaf : coded(samples, settings).leaves) {
    EXPECT_TRUE(std::isnan(leaf.intensity));
  }
}

TEST(SurfaceTile, BelowTheOriginAndHighAbove) {
  std::vector<MapSample> samples;
  for (const double height : {-37.3, 0.0, 88.8}) {
    for (MapSample sample : plane_samples(4, 0)) {
      sample.position.z += height;
      samples.push_back(sample);
    }
  }
  EXPECT_LT(mean_distance(samples, coded(samples, fine())), 0.02);
}

TEST(SurfaceTile, NoCracksAndNoDoublesWhereTilesMeet) {
  // A plane over two tiles: along their border every cell of a footprint is told once.
  const auto all = plane_samples(2 * kSide, 0);
  std::vector<MapSample> left, right;
  for (MapSample sample : all) {
    if (sample.position.y >= kSide) continue;
    const bool first = sample.position.x < kSide;
    if (!first) sample.position.x -= kSide;
    (first ? left : right).push_back(sample);
  }
  std::vector<MapSample> points = tile_points(coded(left, {}), 0.05);
  for (MapSample point : tile_points(coded(right, {}), 0.05)) {
    EXPECT_GE(point.position.x, 0);
    point.position.x += kSide;
    points.push_back(point);
  }
  std::vector<int> along(64);  // .25 m each, 8 m about the border
  for (const MapSample& point : points) {
    EXPECT_LT(point.position.y, kSide);
    const double place = (point.position.x - kSide) * 4 + 32;
    if (place >= 0 && place < 64) ++along[static_cast<std::size_t>(place)];
  }
  const int row = static_cast<int>(kSide / 0.05) * 5;
  for (const int count : along) EXPECT_NEAR(count, row, row / 20);
}

TEST(SurfaceTile, NothingIsATileToo) {
  const auto bytes = encode_surface_tile({}, {}, kSide);
  ASSERT_TRUE(bytes);
  EXPECT_LT(bytes->size(), 12u);
  const auto tile = decode_surface_tile(*bytes);
  ASSERT_TRUE(tile);
  EXPECT_TRUE(tile->leaves.empty());
  EXPECT_EQ(tile->side_m, kSide);
}

TEST(SurfaceTile, SaysWhatItCannotCode) {
  std::vector<MapSample> samples(1);
  const auto refused = [&](const Vec3& p, float weight = 1) {
    samples[0] = {p, weight, 0};
    const auto coded = encode_surface_tile(samples, {}, kSide);
    return !coded && coded.error().code == ErrorCode::invalid_argument;
  };
  EXPECT_TRUE(refused({-0.001, 0, 0}));
  EXPECT_TRUE(refused({0, kSide, 0}));
  EXPECT_TRUE(refused({std::nan(""), 0, 0}));
  EXPECT_TRUE(refused({0, 0, 1e9}));
  EXPECT_TRUE(refused({0, 0, 0}, 0));
  EXPECT_TRUE(refused({0, 0, 0}, std::nanf("")));
  EXPECT_FALSE(refused({0, 0, 0}));
  samples = {{{0, 0, 0}, 1, 0}, {{0, 0, 50000}, 1, 0}};
  EXPECT_EQ(encode_surface_tile(samples, {}, kSide).error().code, ErrorCode::limit_exceeded);
}

TEST(SurfaceTile, SettingsMustMakeSense) {
  EXPECT_TRUE(validate(SurfaceSettings{}, 32));
  const auto refused = [](auto change, double side = 32) {
    SurfaceSettings settings;
    change(settings);
    const Status status = validate(settings, side);
    return !status && !status.error().message.empty();
  };
  EXPECT_TRUE(refused([](SurfaceSettings& s) { s.root_m = 3; }));
  EXPECT_TRUE(refused([](SurfaceSettings& s) { s.smallest_leaf_m = 8; }));
  EXPECT_TRUE(refused([](SurfaceSettings& s) { s.root_m = 16, s.smallest_leaf_m = 0.25; }));
  EXPECT_TRUE(refused([](SurfaceSettings& s) { s.footprint_m = 0.3; }));
  EXPECT_TRUE(refused([](SurfaceSettings& s) { s.root_m = 2, s.footprint_m = 4; }));
  EXPECT_TRUE(refused([](SurfaceSettings& s) { s.step_m = 0; }));
  EXPECT_TRUE(refused([](SurfaceSettings& s) { s.metres_per_bit = std::nan(""); }));
  EXPECT_TRUE(refused([](SurfaceSettings& s) { s.drop_m = -1; }));
  EXPECT_TRUE(refused([](SurfaceSettings& s) { s.intensity = true, s.intensity_step = 0; }));
  EXPECT_TRUE(refused([](SurfaceSettings&) {}, 30));
  EXPECT_TRUE(refused([](SurfaceSettings&) {}, 1024));
}

TEST(SurfaceTile, LimitsHold) {
  const auto bytes = encode_surface_tile(box_samples(kSide), fine(), kSide);
  ASSERT_TRUE(bytes);
  TileLimits limits;
  limits.max_leaves = 10;
  EXPECT_EQ(decode_surface_tile(*bytes, limits).error().code, ErrorCode::limit_exceeded);
  limits = {};
  limits.max_cells = 10000;
  EXPECT_EQ(decode_surface_tile(*bytes, limits).error().code, ErrorCode::limit_exceeded);
}

TEST(SurfaceTile, CutAnywhereItIsDamaged) {
  const auto bytes = encode_surface_tile(box_samples(kSide), {}, kSide);
  ASSERT_TRUE(bytes);
  for (std::size_t size = 0; size < bytes->size(); ++size) {
    const auto tile = decode_surface_tile(ByteSpan(*bytes).first(size));
    // The last bytes may be ones that zeros stand for.
    EXPECT_TRUE(!tile || size + 4 >= bytes->size()) << size;
  }
}

/// Whether the leaves of a tile are the first ones of another, footprints and all.
bool begins_with(const MapTile& longer, const MapTile& tile) {
  if (longer.leaves.size() < tile.leaves.size()) return false;
  for (std::size_t i = 0; i < tile.leaves.size(); ++i) {
    const MapLeaf &a = tile.leaves[i], &b = longer.leaves[i];
    if (a.centre != b.centre || a.axis != b.axis || a.height_m != b.height_m) return false;
    if (a.slope != b.slope || a.curve != b.curve || a.cells != b.cells) return false;
  }
  return std::equal(tile.footprint.begin(), tile.footprint.end(), longer.footprint.begin());
}

TEST(LongerTile, OldLeavesStayAndWhatIsNewIsAdded) {
  const auto plane = plane_samples(kSide, 0.02), box = box_samples(kSide);
  SurfaceSettings settings;
  settings.metres_per_bit = 0.05;
  const auto old = encode_surface_tile(plane, settings, kSide).value();
  const auto longer = append_surface_tile(old, box, settings);
  ASSERT_TRUE(longer) << longer.error().message;
  const MapTile before = decode_surface_tile(old).value();
  const MapTile after = decode_surface_tile(longer->bytes).value();
  EXPECT_TRUE(begins_with(after, before));
  // The box reaches below the lowest row of the plane.
  EXPECT_LT(mean_distance(box, after), 0.05);
  EXPECT_GT(mean_distance(box, before), 0.3);
  EXPECT_LE(mean_distance(plane, after), mean_distance(plane, before));
  const auto alone = encode_surface_tile(box, settings, kSide).value();
  EXPECT_LT(longer->bytes.size(), old.size() + 2 * alone.size());
}

TEST(LongerTile, WhatItTellsAlreadyCostsNothing) {
  const auto plane = plane_samples(kSide, 0.02), box = box_samples(kSide);
  SurfaceSettings settings;
  settings.metres_per_bit = 0.05;
  const auto old = encode_surface_tile(plane, settings, kSide).value();
  const auto again = append_surface_tile(old, plane_samples(kSide, 0.04), settings).value();
  EXPECT_TRUE(again.bytes.empty());
  EXPECT_EQ(again.explained, plane.size());
  const auto with_box = append_surface_tile(old, box, settings).value();
  const auto twice = append_surface_tile(with_box.bytes, box, settings).value();
  EXPECT_LE(static_cast<double>(twice.bytes.size()),
            1.1 * static_cast<double>(with_box.bytes.size()));
  EXPECT_TRUE(append_surface_tile(old, {}, settings).value().bytes.empty());
}

TEST(LongerTile, MayGrowManyTimes) {
  SurfaceSettings settings;
  settings.metres_per_bit = 0.02;
  auto bytes = encode_surface_tile({}, settings, kSide).value();
  std::vector<MapSample> all;
  for (int k = 0; k < 20; ++k) {
    std::vector<MapSample> shelf;
    for (int i = 0; i < 900; ++i) {
      shelf.push_back({{4 + 0.1 * (i % 30), 4 + 0.1 * (i / 30), 0.61 * k - 3}, 1, 0.5f});
    }
    const auto longer = append_surface_tile(bytes, shelf, settings);
    ASSERT_TRUE(longer) << longer.error().message;
    ASSERT_FALSE(longer->bytes.empty()) << k;
    bytes = longer->bytes;
    all.insert(all.end(), shelf.begin(), shelf.end());
  }
  const MapTile tile = decode_surface_tile(bytes).value();
  EXPECT_LT(mean_distance(all, tile), 0.05);
  // Levels of detail join leaves of all passes.
  const MapTile coarse = decode_surface_tile(bytes, {}, 1).value();
  EXPECT_LE(coarse.leaves.size(), tile.leaves.size());
  for (const MapLeaf& leaf : coarse.leaves) EXPECT_LE(leaf.level, 1);
}

TEST(LongerTile, CutAnywhereItIsDamaged) {
  const auto old = encode_surface_tile(plane_samples(kSide, 0.02), {}, kSide).value();
  const auto longer = append_surface_tile(old, box_samples(kSide), {}).value();
  for (std::size_t size = 0; size < longer.bytes.size(); size += 7) {
    const auto cut = ByteSpan(longer.bytes).first(size);
    EXPECT_FALSE(decode_surface_tile(cut)) << size;
    EXPECT_EQ(append_surface_tile(cut, {}, {}).error().code, ErrorCode::corrupt);
  }
}

}  // namespace
}  // namespace curlidar
