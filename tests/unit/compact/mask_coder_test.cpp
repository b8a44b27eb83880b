// SPDX-License-Identifier: BSD-3-Clause
#include "compact/mask_coder.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "compact/mask_contexts.hpp"
#include "compact/mask_model.hpp"
#include "curlidar/io.hpp"
#include "curlidar/project.hpp"
#include "entropy/embedded_priors.hpp"
#include "entropy/priors.hpp"
#include "support/data.hpp"

namespace curlidar::compact {
namespace {

using Mask = std::vector<std::uint8_t>;

/// A repeatable source of bits.
class Noise {
 public:
  std::uint32_t next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::uint32_t>(state_ >> 33);
  }

 private:
  std::uint64_t state_ = 1;
};

/// Something like a scan: sky, ground, objects, a few holes.
Mask scene(const MaskShape& shape) {
  Noise noise;
  Mask mask(shape.rows * shape.columns);
  for (std::size_t i = 0; i < shape.rows; ++i) {
    for (std::size_t j = 0; j < shape.columns; ++j) {
      const bool ground = 3 * i > 2 * shape.rows;
      const bool object = (j / 37 + i / 9) % 3 == 0 && 4 * i > shape.rows;
      const bool hole = noise.next() % 50 == 0;
      mask[i * shape.columns + j] = (ground || object) && !hole;
    }
  }
  return mask;
}

Mask decoded(ByteSpan bytes, const MaskShape& shape, std::size_t* sure = nullptr,
             bool whole = true) {
  Mask mask(shape.rows * shape.columns, 7);
  const std::size_t rows = decode_mask(bytes, shape, whole, mask);
  if (sure != nullptr) *sure = rows;
  return mask;
}

TEST(MaskCoder, GivesBackEveryCellOfManyShapes) {
  const MaskShape shapes[] = {{1, 1, 1},       {1, 40, 40},      {7, 3, 3},     {64, 1, 1},
                              {16, 100, 100},  {16, 100, 1024},  {5, 17, 4096}, {64, 512, 512},
                              {128, 33, 2048}, {128, 600, 1024}, {0, 10, 10},   {10, 0, 10}};
  for (const MaskShape& shape : shapes) {
    const std::size_t cells = shape.rows * shape.columns;
    Noise noise;
    Mask random(cells), rare(cells), flags(cells, 0);
    for (std::size_t i = 0; i < cells; ++i) {
      random[i] = noise.next() & 1;
      rare[i] = noise.next() % 100 == 0;
      flags[i] = i % 3 == 0 ? 200 : 0;
    }
    for (const Mask& mask : {Mask(cells, 0), Mask(cells, 1), random, rare, flags, scene(shape)}) {
      for (const bool thorough : {false, true}) {
        const auto bytes = encode_mask(mask, shape, thorough);
        std::size_t sure = 0;
        const Mask back = decoded(bytes, shape, &sure);
        EXPECT_EQ(sure, shape.rows);
        ASSERT_TRUE(std::equal(mask.begin(), mask.end(), back.begin(), back.end(),
                               [](std::uint8_t a, std::uint8_t b) { return (a != 0) == b; }))
            << shape.rows << " x " << shape.columns;
      }
    }
  }
}

TEST(MaskCoder, EmptyAndFullMasksTakeFewBytes) {
  const MaskShape shape{64, 1024, 1024};
  for (const std::uint8_t value : {std::uint8_t{0}, std::uint8_t{1}}) {
    EXPECT_LT(encode_mask(Mask(64 * 1024, value), shape, true).size(), 30u);
  }
}

TEST(MaskCoder, RowsBeforeACutAreRight) {
  const MaskShape shape{48, 256, 256};
  const Mask mask = scene(shape);
  const auto bytes = encode_mask(mask, shape, false);
  ASSERT_GT(bytes.size(), 100u);
  std::size_t last = 0;
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    std::size_t sure = 0;
    const Mask back = decoded(ByteSpan(bytes).first(size), shape, &sure, false);
    ASSERT_LE(sure, shape.rows);
    ASSERT_GE(sure, last) << "fewer rows from more bytes";
    last = sure;
    const auto end = static_cast<std::ptrdiff_t>(sure * shape.columns);
    ASSERT_TRUE(std::equal(back.begin(), back.begin() + end, mask.begin())) << size;
    ASSERT_TRUE(std::all_of(back.begin() + end, back.end(), [](auto c) { return c == 0; }));
  }
  EXPECT_GT(last, shape.rows - 4);
}

TEST(MaskCoder, AnyBytesDecode) {
  Noise noise;
  for (int round = 0; round < 200; ++round) {
    std::vector<std::byte> bytes(noise.next() % 200);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(noise.next());
    const MaskShape shape{1 + noise.next() % 20, 1 + noise.next() % 90, 1 + noise.next() % 90};
    for (const bool whole : {false, true}) {
      std::size_t sure = 0;
      const Mask mask = decoded(bytes, shape, &sure, whole);
      EXPECT_LE(sure, shape.rows);
      EXPECT_TRUE(std::all_of(mask.begin(), mask.end(), [](auto cell) { return cell <= 1; }));
    }
  }
}

TEST(MaskCoder, ThoroughIsNeverLonger) {
  const MaskShape shape{32, 300, 300};
  Mask stripes(shape.rows * shape.columns);
  for (std::size_t i = 0; i < stripes.size(); ++i) stripes[i] = i % 300 % 5 < 2;
  for (const Mask& mask : {stripes, scene(shape)}) {
    EXPECT_LE(encode_mask(mask, shape, true).size(), encode_mask(mask, shape, false).size());
  }
}

/// Every window gives contexts and weight sets within their tables.
TEST(MaskCoder, ContextsStayInTheirTables) {
  Noise noise;
  const auto word = [&] {
    const std::uint32_t bits = noise.next() << 1 ^ noise.next();
    return noise.next() % 4 == 0 ? 0 : noise.next() % 4 == 0 ? ~0u : bits;
  };
  for (int round = 0; round < 20000; ++round) {
    const MaskWindow window{word(), word(), word(), word(), word()};
    const MaskFeatures features(window);
    for (const std::uint32_t context : mask_contexts(window, features)) {
      ASSERT_LT(context, kMaskContexts);
    }
    const auto sets = mask_weight_sets(window, features, round % 4);
    for (std::size_t s = 0; s < sets.size(); ++s) ASSERT_LT(sets[s], kMaskWeightSets[s]);
  }
}

/// What the window shows of the cells around, checked against plain indexing.
TEST(MaskCoder, WindowShowsTheNeighbours) {
  for (const MaskShape& shape :
       {MaskShape{6, 21, 21}, MaskShape{6, 21, 99}, MaskShape{6, 90, 90}}) {
    const bool closed = shape.columns == shape.turn_columns;
    const Mask mask = scene(shape);
    const auto columns = static_cast<int>(shape.columns);
    const auto cell = [&](int i, int j) -> std::uint32_t {
      if (i < 0) return 0;
      j = closed ? ((j % columns) + columns) % columns : std::clamp(j, 0, columns - 1);
      return mask[static_cast<std::size_t>(i * columns + j)];
    };
    MaskScan scan(shape);
    for (int i = 0; i < static_cast<int>(shape.rows); ++i) {
      scan.begin_row();
      for (int j = 0; j < columns; ++j) {
        scan.begin_cell();
        const MaskWindow& w = scan.window();
        for (int k = -15; k <= 16; ++k) {
          ASSERT_EQ(MaskWindow::at(w.above, k), cell(i - 1, j + k)) << i << ' ' << j << ' ' << k;
          ASSERT_EQ(MaskWindow::at(w.second, k), cell(i - 2, j + k));
          ASSERT_EQ(MaskWindow::at(w.third, k), cell(i - 3, j + k));
        }
        for (int k = 1; k <= 32; ++k) {
          const std::uint32_t expected = j - k >= 0 ? cell(i, j - k) : cell(i - 1, j - k);
          ASSERT_EQ(w.left >> (k - 1) & 1, expected);
          ASSERT_EQ(w.up >> (k - 1) & 1, cell(i - k, j));
        }
        scan.end_cell(cell(i, j) != 0);
      }
    }
  }
}

TEST(MaskCoder, PriorsFillTheTablesExactly) {
  std::vector<BitModel> models(MaskModel::kModels);
  std::vector<std::int32_t> weights(MaskModel::kWeightSets * kMaskInputs);
  const auto model_text = embedded_priors("mask");
  const auto weight_text = embedded_priors("mask_mix");
  EXPECT_TRUE(apply_priors(model_text, models));
  EXPECT_FALSE(apply_priors(model_text, std::span(models).first(models.size() - 1)));
  EXPECT_TRUE(apply_weight_priors(weight_text, weights));
  EXPECT_FALSE(apply_weight_priors(weight_text, std::span(weights).first(weights.size() - 1)));
}

TEST(MaskCoder, RealScanStaysSmall) {
  const auto data = test::data_directory();
  if (!data) GTEST_SKIP() << "the real scans are not here";
  const auto cloud = read_cloud((*data / "kitti_raw/curl_example/0.pcd").string());
  ASSERT_TRUE(cloud);
  const auto detection = detect_sensor(*cloud);
  ASSERT_TRUE(detection);
  const auto grid = project(*cloud, *detection, {RowRule::rings, 0, 1024, 5, {0, 90}});
  ASSERT_TRUE(grid);
  Mask mask;
  for (const Vec3& p : grid->positions) mask.push_back(is_return(p));
  const MaskShape shape{grid->height, grid->width, grid->width};
  const auto bytes = encode_mask(mask, shape, false);
  EXPECT_EQ(decoded(bytes, shape), mask);
  EXPECT_LT(static_cast<double>(bytes.size()) * 8 / static_cast<double>(count_returns(*grid)),
            0.135);
}

}  // namespace
}  // namespace curlidar::compact
