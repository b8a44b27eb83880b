// SPDX-License-Identifier: BSD-3-Clause
#include "peers/pcl_profiles.hpp"

#include <pcl/compression/octree_pointcloud_compression.h>
#include <pcl/point_types.h>

#include <array>
#include <sstream>

#include "peers/peers.hpp"

namespace curlidar::bench {
namespace {

using Coder = pcl::io::OctreePointCloudCompression<pcl::PointXYZ>;
using Points = pcl::PointCloud<pcl::PointXYZ>;

constexpr bool kStatistics = false;

constexpr std::array<pcl::io::compression_Profiles_e, kPclProfiles.size()> kCodes{
    pcl::io::LOW_RES_ONLINE_COMPRESSION_WITHOUT_COLOR,
    pcl::io::MED_RES_ONLINE_COMPRESSION_WITHOUT_COLOR,
    pcl::io::HIGH_RES_ONLINE_COMPRESSION_WITHOUT_COLOR,
    pcl::io::LOW_RES_OFFLINE_COMPRESSION_WITHOUT_COLOR,
    pcl::io::MED_RES_OFFLINE_COMPRESSION_WITHOUT_COLOR,
    pcl::io::HIGH_RES_OFFLINE_COMPRESSION_WITHOUT_COLOR};

}  // namespace

PclStream pcl_encode(const Cloud& cloud, std::size_t profile) {
  const Points::Ptr input(new Points);
  for (const Vec3& p : cloud.positions) {
    if (!is_return(p)) continue;
    input->emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z));
  }
  Coder coder(kCodes.at(profile), kStatistics);
  std::stringstream stream;
  CpuTimer timer;
  coder.encodePointCloud(input, stream);
  const double encode_ms = timer.lap_ms();
  return {stream.str(), encode_ms};
}

PclDecoded pcl_decode(const PclStream& stream, std::size_t profile) {
  Coder coder(kCodes.at(profile), kStatistics);
  std::stringstream bytes(stream.bytes);
  Points::Ptr points(new Points);
  CpuTimer timer;
  coder.decodePointCloud(bytes, points);
  PclDecoded out;
  out.decode_ms = timer.lap_ms();
  for (const pcl::PointXYZ& p : *points) out.cloud.positions.push_back({p.x, p.y, p.z});
  out.cloud.width = static_cast<std::uint32_t>(out.cloud.size());
  return out;
}

}  // namespace curlidar::bench
