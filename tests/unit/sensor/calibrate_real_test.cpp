// SPDX-License-Identifier: BSD-3-Clause
// Real sensors calibrated from one scan, without any table; skipped where the scans are not at
// hand.
#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>

#include "curlidar/io.hpp"
#include "sensor/calibrate.hpp"
#include "support/data.hpp"

namespace curlidar {
namespace {

struct Expected {
  const char* path;
  std::uint32_t slots;
  double range_unit_m;
  bool compensated;
  std::size_t most_loose, most_firings;
  double residual_m;  ///< 95th percentile, across, up and of ranges
};

void PrintTo(const Expected& expected, std::ostream* out) {
  *out << expected.path;
}

class CalibrateReal : public testing::TestWithParam<Expected> {};

TEST_P(CalibrateReal, PutsTheScanOnItsLattice) {
  const Expected& expected = GetParam();
  const auto data = test::data_directory();
  if (!data) GTEST_SKIP() << "no real scans here; set CURLIDAR_DATA";
  const auto path = *data / expected.path;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto cloud = read_cloud(path.string());
  ASSERT_TRUE(cloud) << cloud.error().message;
  const auto rings = detect_sensor(*cloud);
  ASSERT_TRUE(rings);
  const RingedScan scan{&*cloud, &*rings};
  const auto calibration = calibrate(std::span(&scan, 1));
  ASSERT_TRUE(calibration && *calibration);
  const BeamModel& model = (*calibration)->model;
  EXPECT_EQ(model.slots, expected.slots);
  EXPECT_DOUBLE_EQ(model.range_unit_m, expected.range_unit_m);
  EXPECT_EQ((*calibration)->motions.at(0).none(), !expected.compensated);
  EXPECT_TRUE(profile_of(model, rings->sensor, "found"));
  const auto found = find_lattice(*cloud, *rings, std::span(&model, 1));
  ASSERT_TRUE(found && *found);
  const LatticeFit& fit = **found;
  EXPECT_LE(fit.returns - fit.placed, expected.most_loose);
  EXPECT_LE(fit.firings.size(), expected.most_firings);
  EXPECT_LT(fit.residuals.across_p95_m, expected.residual_m);
  EXPECT_LT(fit.residuals.up_p95_m, expected.residual_m);
  EXPECT_LT(fit.residuals.range_p95_m, expected.residual_m);
}

// The XT16's second returns of a firing have no place of their own.
INSTANTIATE_TEST_SUITE_P(
    Scans, CalibrateReal,
    testing::Values(
        Expected{"kitti_object/000000.bin", 4000, .002, false, 0, 2200, .0006},
        Expected{"kitti_raw/sfnd/data_1/0000000000.pcd", 4000, .002, false, 0, 2200, .0006},
        Expected{"kitti_raw/curl_example/0.pcd", 4000, .002, true, 1, 2200, .0006},
        Expected{"kitti_odometry_00/velodyne/000000.bin", 4000, .002, true, 0, 2200, .0006},
        Expected{"velodyne/ndt_omp_hdl32/251370668.pcd", 36000, .002, false, 0, 2200, .00001},
        Expected{"nebula/hesai/xt16/1732848128093928016.pcd", 2000, .004, false, 1300, 2000,
                 .00001},
        Expected{"ouster_sdk/OS-0-128-U1_v2.3.0_1024x10_frame1491.pcd", 1024, .008, false, 0, 1024,
                 .00001},
        Expected{"ouster_sdk/OS-1-32-G_v2.1.1_1024x10_frame638.pcd", 1024, .001, false, 0, 1024,
                 .00001},
        Expected{"ouster_sdk/OS-2-32-U0_v2.0.0_1024x10_frame5424.pcd", 1024, .001, false, 0, 1024,
                 .00001}));

TEST(CalibrateReal, OusterMetadataSaysTheSame) {
  const auto data = test::data_directory();
  if (!data) GTEST_SKIP() << "no real scans here; set CURLIDAR_DATA";
  const auto folder = *data / "ouster_sdk";
  const auto sensor = load_sensor((folder / "OS-0-128-U1_v2.3.0_1024x10.json").string());
  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_EQ(sensor->slots, 1024u);
  EXPECT_DOUBLE_EQ(sensor->range_unit_m, .008);
  const auto model = beam_model_of(*sensor);
  const auto cloud = read_cloud((folder / "OS-0-128-U1_v2.3.0_1024x10_frame1491.pcd").string());
  ASSERT_TRUE(cloud && model);
  const auto rings = detect_sensor(*cloud);
  ASSERT_TRUE(rings);
  const auto fit = find_lattice(*cloud, *rings, std::span(&*model, 1));
  ASSERT_TRUE(fit && *fit);
  EXPECT_EQ((*fit)->placed, (*fit)->returns);
  EXPECT_LT((*fit)->residuals.range_p95_m, .00001);
}

}  // namespace
}  // namespace curlidar
