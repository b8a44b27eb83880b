// SPDX-License-Identifier: BSD-3-Clause
#include "records/walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "records/places.hpp"

namespace curlidar {
namespace {

TEST(Walk, VisitsEveryCellOnceAndIsCodedExactly) {
  std::mt19937 random(9);
  for (const std::uint32_t rows : {1u, 2u, 7u, 64u}) {
    for (const std::uint32_t columns : {1u, 2u, 33u}) {
      Walk walk = Walk::raster(rows);
      walk.by_column = random() % 2 != 0;
      walk.backward = random() % 2 != 0;
      std::shuffle(walk.rows.begin(), walk.rows.end(), random);
      for (auto& first : walk.first) first = static_cast<std::uint32_t>(random() % columns);

      const auto cells = walk.cells(columns);
      EXPECT_EQ(cells.size(), rows * columns);
      EXPECT_EQ(std::set<std::uint32_t>(cells.begin(), cells.end()).size(), cells.size());
      EXPECT_EQ(cells.front(), walk.rows.front() * columns + walk.first[walk.rows.front()]);

      RangeEncoder encoder;
      write_walk(encoder, walk, columns);
      const auto bytes = std::move(encoder).finish();
      RangeDecoder decoder(bytes);
      Walk decoded;
      ASSERT_TRUE(read_walk(decoder, decoded, rows, columns));
      EXPECT_EQ(decoded, walk);
    }
  }
}

TEST(Walk, InterleavedRowsCostLittle) {
  Walk walk = Walk::raster(64);
  for (std::uint32_t k = 0; k < 64; ++k) walk.rows[k] = k / 2 + k % 2 * 32;
  RangeEncoder encoder;
  write_walk(encoder, walk, 2000);
  EXPECT_LT(std::move(encoder).finish().size(), 16u);
}

TEST(Places, AgreeWithPlainCounting) {
  std::mt19937 random(4);
  for (const std::size_t size : {1u, 2u, 63u, 200u}) {
    std::vector<std::uint8_t> holds(size), open(size, 1);
    for (auto& flag : holds) flag = random() % 3 != 0 ? 1 : 0;
    Places places(holds);
    for (std::size_t closed = 0; closed < size; ++closed) {
      const std::size_t from = random() % size;
      std::size_t expected = from;
      while (open[expected] == 0) expected = (expected + 1) % size;
      ASSERT_EQ(places.open_from(from), expected);

      std::vector<std::size_t> left;
      for (std::size_t place = 0; place < size; ++place) {
        ASSERT_EQ(places.rank(place), left.size());
        if (open[place] != 0 && holds[place] != 0) left.push_back(place);
      }
      ASSERT_EQ(places.left(), left.size());
      for (std::size_t rank = 0; rank < left.size(); ++rank) {
        ASSERT_EQ(places.select(rank), left[rank]);
      }
      holds[expected] != 0 ? places.take(expected) : places.close(expected);
      open[expected] = 0;
    }
    EXPECT_EQ(places.first_open(0), size);
  }
}

}  // namespace
}  // namespace curlidar
