// SPDX-License-Identifier: BSD-3-Clause
// PCL's octree compression, the peer of the CURL paper.
#include <pcl/compression/octree_pointcloud_compression.h>
#include <pcl/point_types.h>

#include <sstream>

#include "peers.hpp"

namespace curlidar::bench {
namespace {

using Coder = pcl::io::OctreePointCloudCompression<pcl::PointXYZ>;
using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

/// One point for each voxel: it loses points, but PCL's other mode, which keeps a point's place in
/// its voxel, takes more bits for the same error on every scan we have.
Coder make_coder(double voxel_m) {
  constexpr bool kStatistics = false, kOnePerVoxel = true, kColours = false;
  constexpr unsigned kFrameRate = 1;  // every frame decodes alone
  return Coder(pcl::io::MANUAL_CONFIGURATION, kStatistics, voxel_m, voxel_m, kOnePerVoxel,
               kFrameRate, kColours);
}

Result<Decoded> run(const Grid& grid, double voxel_m) {
  const PclCloud::Ptr input(new PclCloud);
  for (const Vec3& p : grid.returns.positions) {
    input->emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z));
  }
  Decoded result;
  std::stringstream stream;
  CpuTimer timer;
  make_coder(voxel_m).encodePointCloud(input, stream);
  result.encode_ms = timer.lap_ms();
  result.bytes = stream.str().size();
  PclCloud::Ptr output(new PclCloud);
  timer.lap_ms();
  make_coder(voxel_m).decodePointCloud(stream, output);
  result.decode_ms = timer.lap_ms();
  for (const pcl::PointXYZ& p : *output) result.cloud.positions.push_back({p.x, p.y, p.z});
  return result;
}

}  // namespace

Peer pcl_octree_peer() {
  return {
      "pcl-octree", "voxel_m", {.004, .008, .012, .02, .028, .04, .056, .08, .112, .16, .224}, run};
}

}  // namespace curlidar::bench
