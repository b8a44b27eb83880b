// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar {

/// The returns of a cloud in spherical coordinates, one entry each, in the order of the cloud.
struct Returns {
  std::vector<std::uint32_t> slot;  ///< index in the cloud
  std::vector<double> range;        ///< metres from the sensor's origin
  std::vector<double> distance;     ///< metres from the spin axis
  std::vector<double> height;       ///< z, metres
  std::vector<double> azimuth;      ///< radians in (-pi, pi]
  std::vector<double> elevation;    ///< radians
  /// Returns nearer than this say little about the angles of their beams.
  double far_m = 0;

  std::size_t size() const { return slot.size(); }
  bool is_far(std::size_t i) const { return range[i] >= far_m; }
};

Returns gather_returns(const Cloud& cloud);

/// The middle value (upper one of two); reorders its argument, which must not be empty.
double median(std::vector<double>& values);

}  // namespace curlidar
