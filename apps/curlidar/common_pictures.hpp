// SPDX-License-Identifier: BSD-3-Clause
// Options of all pictures.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "curlidar/render.hpp"

namespace curlidar::app {

/// --size, the range of the colours, the camera, the title. `middle`: what the camera turns
/// around; `height_of`: from where the heights of --clip-above count.
void add_picture_options(CLI::App& app, RenderSettings& render, std::string& size,
                         const std::string& middle, const std::string& height_of);

}  // namespace curlidar::app
