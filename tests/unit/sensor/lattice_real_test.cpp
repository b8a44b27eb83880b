// SPDX-License-Identifier: BSD-3-Clause
// Scans of real sensors go back to the integers they came from; skipped where they are not at hand.
#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>

#include "curlidar/io.hpp"
#include "sensor/lattice.hpp"
#include "support/data.hpp"
#include "unit/sensor/lattice_scans.hpp"

namespace curlidar {
namespace {

struct Expected {
  const char* path;
  bool compensated;
  std::size_t most_loose;  ///< second returns, of the XT16
  double residual_m;       ///< 95th percentile, across and up
};

void PrintTo(const Expected& expected, std::ostream* out) {
  *out << expected.path;
}

class LatticeReal : public testing::TestWithParam<Expected> {};

std::vector<BeamModel> candidates() {
  const auto builtin = builtin_beam_models();
  std::vector<BeamModel> models(builtin.begin(), builtin.end());
  models.push_back(test::frozen_table("hdl64e-kitti"));
  return models;
}

TEST_P(LatticeReal, LiesOnItsLattice) {
  const auto data = test::data_directory();
  if (!data) GTEST_SKIP() << "no real scans here; set CURLIDAR_DATA";
  const auto path = *data / GetParam().path;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto cloud = read_cloud(path.string());
  ASSERT_TRUE(cloud) << cloud.error().message;
  const auto rings = detect_sensor(*cloud);
  ASSERT_TRUE(rings);
  const auto found = find_lattice(*cloud, *rings, candidates());
  ASSERT_TRUE(found && *found);
  const LatticeFit& fit = **found;
  EXPECT_EQ(fit.motion.none(), !GetParam().compensated);
  EXPECT_EQ(fit.returns, rings->returns);
  EXPECT_LE(fit.returns - fit.placed, GetParam().most_loose);
  EXPECT_GT(fit.share, .999);
  EXPECT_LT(fit.residuals.across_p95_m, GetParam().residual_m);
  EXPECT_LT(fit.residuals.up_p95_m, GetParam().residual_m);
  EXPECT_LT(fit.residuals.range_p95_m, GetParam().residual_m);
  EXPECT_LT(fit.firings.size(), 2200u);
}

INSTANTIATE_TEST_SUITE_P(
    Scans, LatticeReal,
    testing::Values(Expected{"kitti_object/000000.bin", false, 0, .0006},
                    Expected{"kitti_raw/sfnd/data_1/0000000000.pcd", false, 0, .0006},
                    Expected{"kitti_raw/curl_example/0.pcd", true, 0, .0006},
                    Expected{"kitti_odometry_00/velodyne/000000.bin", true, 0, .0006},
                    Expected{"kitti_odometry_00/velodyne/000013.bin", true, 0, .0006},
                    Expected{"nebula/hesai/xt16/1732848128093928016.pcd", false, 1287, .00001},
                    Expected{"velodyne/ndt_omp_hdl32/251370668.pcd", false, 0, .00001}));

}  // namespace
}  // namespace curlidar
