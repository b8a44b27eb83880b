// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "curlidar/vec3.hpp"

namespace curlidar {

/// A motion of points: rotated, then moved. As a pose it is called `T_map_sensor`: it takes points
/// from the sensor's frame to the map's.
struct RigidMotion {
  std::array<Vec3, 3> rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows of the matrix
  Vec3 move{};

  Vec3 turned(const Vec3& p) const {
    return {dot(rotation[0], p), dot(rotation[1], p), dot(rotation[2], p)};
  }
  Vec3 turned_back(const Vec3& p) const {
    return rotation[0] * p.x + rotation[1] * p.y + rotation[2] * p.z;
  }
  Vec3 operator()(const Vec3& p) const { return turned(p) + move; }
  Vec3 undo(const Vec3& p) const { return turned_back(p - move); }

  /// The motion that undoes this one.
  RigidMotion inverse() const {
    RigidMotion back;
    back.rotation = {{{rotation[0].x, rotation[1].x, rotation[2].x},
                      {rotation[0].y, rotation[1].y, rotation[2].y},
                      {rotation[0].z, rotation[1].z, rotation[2].z}}};
    back.move = turned_back(move) * -1;
    return back;
  }
  /// As matrices: (a * b)(p) is a(b(p)).
  friend RigidMotion operator*(const RigidMotion& a, const RigidMotion& b) {
    RigidMotion both;
    for (std::size_t row = 0; row < 3; ++row) both.rotation[row] = b.turned_back(a.rotation[row]);
    both.move = a(b.move);
    return both;
  }
  friend bool operator==(const RigidMotion&, const RigidMotion&) = default;
};

}  // namespace curlidar
