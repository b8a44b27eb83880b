// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/sensor.hpp"

namespace curlidar {

/// The beams of a profile, ready to be asked which of them made a return.
class Beams {
 public:
  explicit Beams(const SensorProfile& profile);

  std::size_t size() const { return slopes_.size(); }
  /// The beam nearest in angle to a return at `height` and `distance` from the spin axis.
  std::uint16_t nearest(double distance, double height) const;
  /// Angle of the return above the beam, radians, seen from the sensor's origin.
  double angle_above(std::size_t beam, double distance, double height) const;
  /// Half the angle to the neighbours, the nearer one.
  double half_gap(std::size_t beam) const { return half_gaps_[beam]; }

 private:
  double height_at(std::size_t beam, double distance) const {
    return heights_[beam] + (distance - radius_) * slopes_[beam];
  }

  std::vector<double> slopes_, heights_, half_gaps_;
  double radius_ = 0;
};

}  // namespace curlidar
