// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "support/real_compact_scans.hpp"

namespace curlidar::compact {
namespace {

class RealScans : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Sensors, RealScans,
                         testing::Values("kitti_odometry_00/velodyne/000003.bin",
                                         "ouster_sdk/OS-1-32-G_v2.1.1_1024x10_frame638.pcd",
                                         "nebula/hesai/xt16/1732848128093928016.pcd"));

TEST_P(RealScans, ComeBackAtLowEffort) {
  const auto data = test::data_directory();
  if (!data) GTEST_SKIP() << "no scans: set CURLIDAR_DATA to the folder with MANIFEST.tsv";
  const auto scan = test::project_real_scan((*data / GetParam()).string());
  if (!scan) GTEST_SKIP() << GetParam() << " is not in the data folder";
  for (const double error : {.05, .015, .003}) {
    ScanSettings settings;
    settings.steps = steps_for_error(static_cast<std::int64_t>(error * kRangeUnit));
    settings.effort = 1;
    const auto written = encode_scan(scan->image, scan->table, settings);
    ASSERT_TRUE(written) << written.error().message;
    const auto read = decode_scan(test::views_of(written->chunks));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->range, written->decoded.range);
    // Without residuals one layer a leaf, which is all that this effort tries, is far from enough.
    EXPECT_LT(test::mean_error(scan->image, read->range) / kRangeUnit,
              settings.steps.residual_step > 0 ? 2 * error : 8 * error);
    EXPECT_LT(test::total_bits(written->breakdown),
              8 * static_cast<double>(written->statistics.returns));
  }
}

}  // namespace
}  // namespace curlidar::compact
