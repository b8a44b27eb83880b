// SPDX-License-Identifier: BSD-3-Clause
// KITTI and nuScenes records laid out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "curlidar/io.hpp"
#include "support/clouds.hpp"

namespace curlidar {
namespace {

using testing::HasSubstr;

std::vector<std::byte> floats(int count) {
  std::vector<std::byte> bytes;
  for (int i = 0; i < count; ++i) test::put(bytes, static_cast<float>(i) + 0.5f);
  return bytes;
}

TEST(FloatRecords, Kitti) {
  const auto cloud = parse_cloud(floats(8), "000000.bin");
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->positions, (std::vector<Vec3>{{0.5, 1.5, 2.5}, {4.5, 5.5, 6.5}}));
  EXPECT_EQ(cloud->position_type, ScalarType::float32);
  ASSERT_EQ(cloud->attributes.size(), 1u);
  EXPECT_EQ(std::get<std::vector<float>>(cloud->find("intensity")->values),
            (std::vector<float>{3.5, 7.5}));
  EXPECT_EQ(*format_cloud(*cloud, "a.bin"), floats(8));
}

TEST(FloatRecords, Nuscenes) {
  const auto cloud = parse_cloud(floats(10), "LIDAR_TOP.pcd.bin");
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->positions, (std::vector<Vec3>{{0.5, 1.5, 2.5}, {5.5, 6.5, 7.5}}));
  ASSERT_EQ(cloud->attributes.size(), 2u);
  EXPECT_EQ(std::get<std::vector<float>>(cloud->find("ring")->values),
            (std::vector<float>{4.5, 9.5}));
  EXPECT_EQ(*format_cloud(*cloud, "a.pcd.bin"), floats(10));
}

TEST(FloatRecords, EmptyFilesAreEmptyClouds) {
  EXPECT_EQ(parse_cloud({}, "a.bin")->size(), 0u);
  EXPECT_EQ(parse_cloud({}, "a.pcd.bin")->size(), 0u);
}

TEST(FloatRecords, PartsOfARecordAreAnError) {
  for (std::size_t size = 1; size < 40; ++size) {
    const std::vector<std::byte> bytes(size);
    EXPECT_EQ(parse_cloud(bytes, "a.bin").has_value(), size % 16 == 0) << size;
    EXPECT_EQ(parse_cloud(bytes, "a.pcd.bin").has_value(), size % 20 == 0) << size;
  }
  EXPECT_THAT(parse_cloud(std::vector<std::byte>(33), "a.bin").error().message,
              HasSubstr("a.bin: byte 32: 1 bytes are left"));
}

}  // namespace
}  // namespace curlidar
