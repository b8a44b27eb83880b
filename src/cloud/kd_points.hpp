// SPDX-License-Identifier: BSD-3-Clause
// Points in the shape that nanoflann asks for.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/vec3.hpp"

namespace curlidar {

struct KdPoints {
  std::vector<Vec3> points;

  // nanoflann prescribes these names.
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    const Vec3& p = points[i];
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  }
  template <class BoundingBox>
  bool kdtree_get_bbox(BoundingBox&) const {
    return false;
  }
};

}  // namespace curlidar
