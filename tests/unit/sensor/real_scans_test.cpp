// SPDX-License-Identifier: BSD-3-Clause
// Detection on scans of real sensors; skipped where the scans are not at hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "curlidar/io.hpp"
#include "curlidar/sensor.hpp"
#include "support/data.hpp"

namespace curlidar {
namespace {

struct Expected {
  const char* path;
  const char* sensor;
  std::size_t rings;
  std::uint32_t columns;
  RingSource source;
};

class RealScan : public testing::TestWithParam<Expected> {
 protected:
  void SetUp() override {
    const auto data = test::data_directory();
    if (!data) GTEST_SKIP() << "no real scans here; set CURLIDAR_DATA";
    const auto path = *data / GetParam().path;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    auto read = read_cloud(path.string());
    ASSERT_TRUE(read) << read.error().message;
    cloud_ = std::move(*read);
  }
  Cloud cloud_;
};

TEST_P(RealScan, IsRecognised) {
  const auto d = detect_sensor(cloud_);
  ASSERT_TRUE(d) << d.error().message;
  EXPECT_EQ(d->sensor.name, GetParam().sensor);
  EXPECT_EQ(d->sensor.rings.size(), GetParam().rings);
  EXPECT_EQ(d->sensor.columns, GetParam().columns);
  EXPECT_EQ(d->source, GetParam().source);
  EXPECT_EQ(d->sensor.pattern, ScanPattern::spinning);
  EXPECT_TRUE(validate(d->sensor));
  EXPECT_EQ(d->returns, count_returns(cloud_));
  EXPECT_EQ(d->points, d->returns + d->zero + d->not_finite);
  ASSERT_EQ(d->ring_of_point.size(), cloud_.size());
  ASSERT_EQ(d->ring_elevations.size(), GetParam().rings);
  EXPECT_TRUE(std::is_sorted(d->ring_elevations.rbegin(), d->ring_elevations.rend()));
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    ASSERT_EQ(d->ring_of_point[i] == kNoRing, !is_return(cloud_.positions[i])) << i;
    if (d->ring_of_point[i] == kNoRing) continue;
    ASSERT_LT(d->ring_of_point[i], GetParam().rings) << i;
  }
}

TEST_P(RealScan, RingsFromElevationsAgree) {
  // Two independent ways: how the scan is laid out, and the beams nearest to each return.
  const auto found = detect_sensor(cloud_);
  ASSERT_TRUE(found);
  const auto nearest = assign_rings(cloud_, found->sensor);
  ASSERT_TRUE(nearest);
  std::size_t same = 0;
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    same +=
        found->ring_of_point[i] != kNoRing && found->ring_of_point[i] == nearest->ring_of_point[i];
  }
  // Motion-compensated scans bend their rings.
  EXPECT_GT(static_cast<double>(same), 0.8 * static_cast<double>(found->returns));
}

constexpr auto kWraps = RingSource::azimuth_wraps;
constexpr auto kClusters = RingSource::clustered;
constexpr auto kAttribute = RingSource::ring_attribute;
INSTANTIATE_TEST_SUITE_P(
    Data, RealScan,
    testing::Values(
        Expected{"kitti_object/000000.bin", "hdl64e-kitti", 64, 2083, kWraps},
        Expected{"kitti_raw/curl_example/0.pcd", "hdl64e-kitti", 64, 2083, kWraps},
        Expected{"kitti_raw/sfnd/data_1/0000000000.pcd", "hdl64e-kitti", 64, 2083, kWraps},
        Expected{"kitti_raw/sfnd/data_1/0000000004.pcd", "hdl64e-kitti", 64, 2083, kWraps},
        Expected{"kitti_odometry_00/velodyne/000000.bin", "hdl64e-kitti", 64, 2083, kWraps},
        Expected{"kitti_odometry_00/velodyne/000010.bin", "hdl64e-kitti", 64, 2083, kWraps},
        Expected{"velodyne/ndt_omp_hdl32/251370668.pcd", "hdl32e", 32, 2170, kClusters},
        Expected{"velodyne/ndt_omp_hdl32/251371071.pcd", "hdl32e", 32, 2170, kClusters},
        Expected{"nebula/hesai/xt16/1732848128093928016.pcd", "pandarxt16", 16, 2000, kClusters},
        Expected{"ouster_sdk/OS-0-128-U1_v2.3.0_1024x10_frame1491.pcd", "auto", 128, 1024,
                 kAttribute},
        Expected{"ouster_sdk/OS-1-32-G_v2.1.1_1024x10_frame638.pcd", "auto", 32, 1024, kAttribute},
        Expected{"ouster_sdk/OS-2-32-U0_v2.0.0_1024x10_frame5424.pcd", "auto", 32, 1024,
                 kAttribute},
        Expected{"tls_indoor/room_scan1.pcd", "auto", 181, 298, kClusters},
        Expected{"tls_indoor/room_scan2.pcd", "auto", 181, 299, kClusters}),
    [](const auto& param) {
      std::string name = param.param.path;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
      return name;
    });

TEST(RealMetadata, FitsTheScanItCameWith) {
  const auto data = test::data_directory();
  if (!data) GTEST_SKIP() << "no real scans here; set CURLIDAR_DATA";
  const auto folder = *data / "ouster_sdk";
  const auto sensor = load_sensor((folder / "OS-0-128-U1_v2.3.0_1024x10.json").string());
  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_EQ(sensor->rings.size(), 128u);
  EXPECT_EQ(sensor->columns, 1024u);
  const auto cloud = read_cloud((folder / "OS-0-128-U1_v2.3.0_1024x10_frame1491.pcd").string());
  ASSERT_TRUE(cloud) << cloud.error().message;
  const auto found = detect_sensor(*cloud);
  const auto given = assign_rings(*cloud, *sensor);
  ASSERT_TRUE(found && given);
  // The beams start beside the spin axis, which the metadata knows and moves near returns.
  std::size_t same = 0;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    same +=
        found->ring_of_point[i] != kNoRing && found->ring_of_point[i] == given->ring_of_point[i];
  }
  EXPECT_GT(static_cast<double>(same), 0.99 * static_cast<double>(found->returns));
}

TEST(LoadSensor, TakesNamesAndFiles) {
  EXPECT_EQ(load_sensor("vlp16")->name, "vlp16");
  const auto missing = load_sensor("no/such/file.toml");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, testing::HasSubstr("no/such/file.toml"));
  EXPECT_EQ(load_sensor("some/file.yaml").error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(load_sensor("vlp61").error().code, ErrorCode::not_found);

  const auto path = std::filesystem::temp_directory_path() / "curlidar_sensor_test.toml";
  const std::string text = sensor_to_toml(*builtin_sensor("vlp16"));
  ASSERT_TRUE(write_file(path.string(), std::as_bytes(std::span(text.data(), text.size()))));
  const auto loaded = load_sensor(path.string());
  std::filesystem::remove(path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->rings.size(), 16u);
}

}  // namespace
}  // namespace curlidar
