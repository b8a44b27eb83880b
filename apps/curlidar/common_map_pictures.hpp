// SPDX-License-Identifier: BSD-3-Clause
// Pictures of maps.
#pragma once

#include <string>

#include "curlidar/cloud.hpp"
#include "curlidar/render.hpp"

namespace curlidar::app {

/// The cloud about the middle of what most of it covers, from where the views look at it; heights
/// stay those of the map. `size` is WxH, height 0: as high as the map is long.
/// Errors are those of its attribute "error".
Image map_picture(Cloud cloud, RenderSettings settings, const std::string& size);

}  // namespace curlidar::app
