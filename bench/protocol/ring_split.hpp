// SPDX-License-Identifier: BSD-3-Clause
// A scan without some of its rings, and what these saw.
#pragma once

#include <cstdint>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/sensor.hpp"

namespace curlidar::bench {

struct RingSplit {
  Cloud coded;  ///< returns of the rings 0, K, 2K .., without attributes
  std::vector<std::uint16_t> ring_of_point;  ///< of the coded ones, in the reduced sensor
  SensorProfile sensor;                      ///< with these rings only
  std::vector<double> elevations;            ///< of these rings as the scan shows them, radians
  std::vector<Vec3> held_out;                ///< returns of the rings between them
  std::vector<std::uint16_t> held_out_ring;  ///< their rings in the whole sensor
  /// Unit directions in which those rings had no return between two others.
  std::vector<Vec3> gaps;
  std::vector<std::uint16_t> gap_ring;  ///< their rings in the whole sensor
};

/// Keeps every `every`-th ring. Rings below the last kept one lie between nothing and are in
/// neither part. The detection must be that of the cloud.
RingSplit split_rings(const Cloud& cloud, const Detection& detection, std::uint32_t every);

}  // namespace curlidar::bench
