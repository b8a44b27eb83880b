// SPDX-License-Identifier: BSD-3-Clause
// PCL's octree compression as its users meet it: the six profiles without colour, which the CURL
// paper compares with.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "curlidar/cloud.hpp"

namespace curlidar::bench {

/// As the paper's columns are named.
inline constexpr std::array<const char*, 6> kPclProfiles{
    "low online", "mid online", "high online", "low offline", "mid offline", "high offline"};

struct PclStream {
  std::string bytes;
  double encode_ms = 0;  ///< CPU time; of a coder made for this one cloud, which is not counted
};
struct PclDecoded {
  Cloud cloud;
  double decode_ms = 0;  ///< CPU time, likewise
};

// pcl_profiles.cpp, only where PCL was found (CURLIDAR_BENCH_HAS_PCL). `profile` is an index of the
// names above, below 6. The first frame of a stream, which decodes alone.
PclStream pcl_encode(const Cloud& cloud, std::size_t profile);
PclDecoded pcl_decode(const PclStream& stream, std::size_t profile);

}  // namespace curlidar::bench
