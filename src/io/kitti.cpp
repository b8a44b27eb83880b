// SPDX-License-Identifier: BSD-3-Clause
// KITTI's velodyne scans: N records of little-endian float32 x, y, z, intensity; no header.
#include "io/float_records.hpp"

namespace curlidar::io {
namespace {

const std::vector<std::string> kFields{"x", "y", "z", "intensity"};

}  // namespace

Result<Cloud> parse_kitti(const Source& source) {
  return parse_float_records(source, "KITTI", kFields);
}

Result<Bytes> format_kitti(const Cloud& cloud) {
  return format_float_records(cloud, "KITTI", kFields);
}

}  // namespace curlidar::io
