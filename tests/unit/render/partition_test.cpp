// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "curlidar/render.hpp"

namespace curlidar {
namespace {

using Pixel = std::array<std::uint8_t, 3>;

Pixel pixel(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::size_t at = (std::size_t{y} * image.width + x) * 3;
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

/// 4 x 16 cells at 5 m, at 10 m from column 8 on.
Cloud grid() {
  Cloud cloud;
  cloud.width = 16;
  cloud.height = 4;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 16; ++j) {
      const double azimuth = -std::numbers::pi + std::numbers::pi * j / 8;
      cloud.positions.push_back(direction_of(0.1 - 0.05 * i, azimuth) * (j < 8 ? 5 : 10));
    }
  }
  return cloud;
}

RenderSettings settings(View view) {
  RenderSettings s;
  s.view = view;
  s.colour = ColourBy::range;
  s.width = 160;  // 10 pixels a cell, one stripe
  s.value_min = 4;
  s.value_max = 11;
  return s;
}

const std::vector<PartitionBlock> kBlocks{{0, 0, 4, 8, 1}, {0, 8, 4, 8, 2}};

TEST(RenderPartition, LeftOfThePictureIsTheLargestAzimuth) {
  const auto image = render_partition(grid(), kBlocks, std::vector<std::uint8_t>(64, 0),
                                      settings(View::partition));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 160u);
  EXPECT_NE(pixel(*image, 5, 5), pixel(*image, 155, 5));    // 10 m and 5 m
  EXPECT_EQ(pixel(*image, 15, 5), pixel(*image, 75, 35));   // both 10 m
  EXPECT_EQ(pixel(*image, 85, 5), pixel(*image, 155, 35));  // both 5 m
  EXPECT_NE(pixel(*image, 80, 5), pixel(*image, 85, 5));    // the outline of the right block
  EXPECT_NE(pixel(*image, 0, 5), pixel(*image, 80, 5));     // of two layers and of one
}

TEST(RenderPartition, DegreesColourWholeBlocks) {
  const std::vector<PartitionBlock> blocks{{0, 0, 4, 8, 1}, {0, 8, 4, 4, 3}, {0, 12, 4, 4, 9}};
  const auto image = render_partition(grid(), blocks, {}, settings(View::degrees));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(pixel(*image, 85, 5), pixel(*image, 155, 35));  // degree 1
  EXPECT_EQ(pixel(*image, 5, 5), pixel(*image, 35, 35));    // 9 is drawn as 4 or more
  EXPECT_NE(pixel(*image, 5, 5), pixel(*image, 45, 5));
  EXPECT_NE(pixel(*image, 45, 5), pixel(*image, 85, 5));
}

TEST(RenderPartition, LayersHaveTheirColours) {
  std::vector<std::uint8_t> layer(64, 0);
  layer[8] = 1;
  const auto image = render_partition(grid(), kBlocks, layer, settings(View::layers));
  ASSERT_TRUE(image);
  EXPECT_EQ(pixel(*image, 5, 5), pixel(*image, 155, 5));
  EXPECT_NE(pixel(*image, 75, 5), pixel(*image, 65, 5));
}

TEST(RenderPartition, NarrowPicturesHaveMoreStripes) {
  RenderSettings narrow = settings(View::layers);
  narrow.width = 32;
  const auto image = render_partition(grid(), kBlocks, std::vector<std::uint8_t>(64, 0), narrow);
  ASSERT_TRUE(image);
  EXPECT_GT(image->height, 2 * 4 * 4u);
}

TEST(RenderPartition, WhatDoesNotFitIsRefused) {
  const std::vector<std::uint8_t> layer(64, 0);
  EXPECT_FALSE(render_partition(grid(), kBlocks, layer, settings(View::range_image)));
  EXPECT_FALSE(render_partition(grid(), kBlocks, {}, settings(View::layers)));
  EXPECT_FALSE(render_partition(Cloud{}, {}, {}, settings(View::layers)));
  EXPECT_FALSE(render(grid(), settings(View::partition)));
  // Blocks beyond the grid are not drawn, and do no harm.
  EXPECT_TRUE(render_partition(grid(), {{3, 15, 9, 9, 7}, {9, 99, 1, 1, 1}}, layer,
                               settings(View::layers)));
}

}  // namespace
}  // namespace curlidar
