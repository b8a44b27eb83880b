// SPDX-License-Identifier: BSD-3-Clause
// nuScenes' LIDAR_TOP sweeps (.pcd.bin): N records of little-endian float32 x, y, z, intensity,
// ring; no header.
#include "io/float_records.hpp"

namespace curlidar::io {
namespace {

const std::vector<std::string> kFields{"x", "y", "z", "intensity", "ring"};

}  // namespace

Result<Cloud> parse_nuscenes(const Source& source) {
  return parse_float_records(source, "nuScenes", kFields);
}

Result<Bytes> format_nuscenes(const Cloud& cloud) {
  return format_float_records(cloud, "nuScenes", kFields);
}

}  // namespace curlidar::io
