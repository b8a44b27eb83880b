// SPDX-License-Identifier: BSD-3-Clause
#include "peers.hpp"

namespace curlidar::bench {

std::vector<double> thinned(const std::vector<double>& sweep, std::size_t count) {
  if (count == 0 || sweep.size() <= count) return sweep;
  if (count == 1) return {sweep[sweep.size() / 2]};
  std::vector<double> chosen;
  const std::size_t last = sweep.size() - 1, gaps = count - 1;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(sweep[(i * last + gaps / 2) / gaps]);
  return chosen;
}

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
