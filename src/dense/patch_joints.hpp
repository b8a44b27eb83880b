// SPDX-License-Identifier: BSD-3-Clause
// Patches that were coded one by one made to meet where they are one surface.
#pragma once

#include <span>
#include <vector>

#include "curlidar/field.hpp"

namespace curlidar {

/// By how much the ranges of cells change, metres, so that steps between neighbouring patches of a
/// row go: both sides meet half-way, fading out over four cells. Only steps that the coding may
/// have made go, of up to half of its own step where both sides slope alike, and not over gaps
/// between firings; no cell moves by more than that. Empty if nothing moves. `points`:
/// Field::cell_points. On rings held out of six real scans this brings the median error down by up
/// to 4 %; the same between rows makes it worse. O(cells).
std::vector<float> patch_joints(const Field& field, std::span<const Vec3> points);

}  // namespace curlidar
