// SPDX-License-Identifier: BSD-3-Clause
#include "peers.hpp"

namespace curlidar::bench {

std::vector<Peer> all_peers() {
  std::vector<Peer> peers{range_image_peer(png_coder()), range_image_peer(zstd_coder()),
                          zstd_delta_peer()};
#ifdef CURLIDAR_BENCH_HAS_JXL
  peers.push_back(range_image_peer(jxl_coder()));
#else
  peers.push_back({"jpeg-xl-e9", {}, {}, {}});
#endif
#ifdef CURLIDAR_BENCH_HAS_DRACO
  peers.push_back(draco_peer());
#else
  peers.push_back({"draco-kd-tree", {}, {}, {}});
#endif
#ifdef CURLIDAR_BENCH_HAS_PCL
  peers.push_back(pcl_octree_peer());
#else
  peers.push_back({"pcl-octree", {}, {}, {}});
#endif
  return peers;
}

}  // namespace curlidar::bench
