// SPDX-License-Identifier: BSD-3-Clause
#include "compact/ray_tables.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "compact/scan_types.hpp"

namespace curlidar::compact {
namespace {

TEST(RayTables, AreNumberedFromOneAndFitTheFormat) {
  ASSERT_FALSE(beam_tables().empty());
  std::uint32_t number = 0;
  for (const BeamTable& table : beam_tables()) {
    SCOPED_TRACE(table.name);
    EXPECT_EQ(table.number, ++number);
    EXPECT_EQ(beam_table(table.number), &table);
    EXPECT_EQ(beam_table(table.name), &table);
    EXPECT_GE(table.slots, 1u);
    EXPECT_LE(table.slots, kMaxSlots);
    ASSERT_EQ(table.elevation.size(), table.rays.size());
    ASSERT_FALSE(table.rays.empty());
    for (std::size_t row = 0; row < table.rays.size(); ++row) {
      const Ray& ray = table.rays[row];
      EXPECT_LE(std::abs(table.elevation[row]), kMaxElevation);
      EXPECT_LE(std::abs(ray.height), kMaxRowOffset);
      EXPECT_LE(std::abs(ray.lateral), kMaxRowOffset);
      // A phase is what is left of a range unit.
      EXPECT_LE(std::abs(ray.range_phase), std::int64_t(table.range_unit_q48 >> 33) + 1);
    }
  }
  EXPECT_EQ(beam_table(0u), nullptr);
  EXPECT_EQ(beam_table(number + 1), nullptr);
  EXPECT_EQ(beam_table("no such sensor"), nullptr);
}

TEST(RayTables, KittisSensorIsAsPublished) {
  const BeamTable* table = beam_table("hdl64e-kitti");
  ASSERT_NE(table, nullptr);
  EXPECT_EQ(table->number, 1u);  // frozen
  EXPECT_EQ(table->slots, 4000u);
  EXPECT_EQ(table->range_unit_q48, 562949953421u);
  ASSERT_EQ(table->rays.size(), 64u);
  const auto degrees = [](std::int32_t angle) { return angle / 4294967296.0 * 360; };
  EXPECT_NEAR(degrees(table->elevation.front()), 1.94, .01);
  EXPECT_NEAR(degrees(table->elevation.back()), -25.0, .01);
  for (const Ray& ray : table->rays) EXPECT_EQ(std::abs(ray.lateral), 1704);  // 26 mm
}

}  // namespace
}  // namespace curlidar::compact
