// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "reconstruct/view.hpp"

namespace curlidar {

/// Unit normals of the surface at points of it, towards the origin: across what the field believes
/// beside each point on the same surface. NaN where a point is, or where its surface is too small
/// to say. Four to eight evaluations a point; threads change nothing.
std::vector<Vec3> normals_at(const ScanView& view, std::span<const Vec3> points,
                             std::size_t threads);

}  // namespace curlidar
