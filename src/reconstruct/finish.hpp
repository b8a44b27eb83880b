// SPDX-License-Identifier: BSD-3-Clause
// From points to clouds: the attributes that the settings ask for.
#pragma once

#include "reconstruct/view.hpp"

namespace curlidar {

/// Attributes of coded returns: they are sure, and originals.
void mark_coded(const ReconstructSettings& settings, Cloud& coded);
/// Attributes normal_x, normal_y, normal_z.
void add_normals(const ScanView& view, Cloud& cloud);

/// The cloud of invented points with the scan's attributes and what the settings ask for.
Cloud finish(const ScanView& view, Samples samples);

/// Invented points behind the coded returns, with what the settings ask for.
Cloud finish_behind(const ScanView& view, Cloud coded, Samples samples);

/// Invalid_argument if originals are to be kept where they have no place.
Status check_kept(const ReconstructSettings& settings);

}  // namespace curlidar
