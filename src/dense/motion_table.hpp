// SPDX-License-Identifier: BSD-3-Clause
// The motion of a scan at every azimuth, looked up.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/field.hpp"

namespace curlidar {

class MotionTable {
 public:
  explicit MotionTable(const Field& field);

  bool moves() const { return !nodes_.empty(); }
  /// Field::motion_at for azimuths in [-pi, pi], within 1 um of it at 100 m. O(1).
  RigidMotion at(double azimuth) const;

 private:
  std::vector<RigidMotion> nodes_;  ///< evenly from -pi to pi; empty: nothing moves
};

}  // namespace curlidar
