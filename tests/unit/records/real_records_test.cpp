// SPDX-License-Identifier: BSD-3-Clause
// Order and attributes of real scans whose slots are laser by firing: exact, and small.
#include <gtest/gtest.h>

#include <cmath>

#include "curlidar/io.hpp"
#include "records/attributes.hpp"
#include "support/data.hpp"

namespace curlidar {
namespace {

struct RealScan {
  const char* file;
  std::uint32_t rows;
  bool by_firing;                     ///< slot = firing * rows + row, else row * columns + firing
  double order_bits, attribute_bits;  ///< most that a point may cost
};

class RealRecords : public testing::TestWithParam<RealScan> {};

TEST_P(RealRecords, ComeBackExactlyAndSmall) {
  const auto folder = test::data_directory();
  if (!folder) GTEST_SKIP() << "no real scans: set CURLIDAR_DATA";
  const RealScan& scan = GetParam();
  if (!std::filesystem::exists(*folder / scan.file)) GTEST_SKIP() << "no " << scan.file;
  const auto cloud = read_cloud((*folder / scan.file).string());
  ASSERT_TRUE(cloud) << cloud.error().message;

  const auto columns = static_cast<std::uint32_t>(cloud->size() / scan.rows);
  const std::size_t cells = std::size_t{scan.rows} * columns;
  ASSERT_EQ(cells, cloud->size());
  std::vector<std::uint8_t> occupied(cells);
  std::vector<std::int32_t> ranges(cells);
  std::vector<std::size_t> cell_of;
  for (std::size_t slot = 0; slot < cells; ++slot) {
    const Vec3& p = cloud->positions[slot];
    if (!is_return(p)) continue;
    const std::size_t cell = scan.by_firing ? slot % scan.rows * columns + slot / scan.rows : slot;
    occupied[cell] = 1;
    ranges[cell] = static_cast<std::int32_t>(65536 * std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z));
    cell_of.push_back(cell);
  }
  std::vector<std::uint32_t> record(cells);
  std::uint32_t records = 0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    record[cell] = records;
    records += occupied[cell];
  }
  CloudOrder order = order_of(*cloud);
  for (std::size_t i = 0; i < cell_of.size(); ++i) order.record[i] = record[cell_of[i]];

  const RecordGeometry geometry{{scan.rows, columns, occupied, 0}, ranges, {}};
  const auto order_bytes = encode_order(order, geometry.grid);
  const auto decoded = decode_order({ChunkType::order, order_bytes, 0}, geometry.grid, cells);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(*decoded == order);
  EXPECT_LT(8. * static_cast<double>(order_bytes.size()) / records, scan.order_bits);

  const auto bytes = write_records(cloud->attributes, order, geometry);
  ASSERT_TRUE(bytes);
  const auto attributes =
      read_records({ChunkType::records, *bytes, 0}, *decoded, geometry, std::uint64_t{1} << 30);
  ASSERT_TRUE(attributes) << attributes.error().message;
  ASSERT_EQ(attributes->size(), cloud->attributes.size());
  for (std::size_t i = 0; i < attributes->size(); ++i) {
    EXPECT_TRUE((*attributes)[i].values == cloud->attributes[i].values);
  }
  EXPECT_LT(8. * static_cast<double>(bytes->size()) / records, scan.attribute_bits);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealRecords,
    testing::Values(RealScan{"velodyne/ndt_omp_hdl32/251370668.pcd", 32, true, .02, 3.1},
                    RealScan{"ouster_sdk/OS-0-128-U1_v2.3.0_1024x10_frame1491.pcd", 128, false, .02,
                             3.9}),
    [](const auto& test) { return test.index == 0 ? "Hdl32e" : "Os0"; });

}  // namespace
}  // namespace curlidar
