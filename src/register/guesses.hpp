// SPDX-License-Identifier: BSD-3-Clause
// Many descents from many guesses, and which of them to believe.
#pragma once

#include <span>

#include "curlidar/register.hpp"
#include "register/align.hpp"
#include "register/target_surface.hpp"

namespace curlidar::registration {

/// invalid_argument if a setting makes no sense.
Status check_settings(const RegisterSettings& settings);

/// The points of a scan that are laid on others. invalid_argument if they are too few.
Result<std::vector<Vec3>> usable_points(const Cloud& scan, const RegisterSettings& settings);

/// Tries the guess and others ahead of and behind it along its x axis; refines the best. In doubt
/// if another place is nearly as good.
Registration align_from_many(std::span<const Vec3> source, TargetSurface& target,
                             const RigidMotion& guess, const RegisterSettings& settings);

/// Says in `doubt` why a result should not be trusted, if so.
void judge(Registration& result, double least_matched_share);

/// The whole descent of the settings.
Descent full_descent(const RegisterSettings& settings);

}  // namespace curlidar::registration
