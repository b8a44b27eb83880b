// SPDX-License-Identifier: BSD-3-Clause
// The ways of looking at a cloud. All expect at least one return and checked settings.
#pragma once

#include "render/canvas.hpp"
#include "render/scale.hpp"

namespace curlidar::drawing {

/// Rows over columns as a person at the sensor sees them: left is left, up is up.
/// Organised clouds keep their rows; the rings of others are detected.
Result<Canvas> draw_range_image(const Cloud& cloud, const RenderSettings& settings,
                                const Scale& scale);
/// From above: forward (x) is up, left (y) is left, with range circles.
Canvas draw_birds_eye(const Cloud& cloud, const RenderSettings& settings, const Scale& scale);
/// From a camera that orbits the sensor.
Canvas draw_perspective(const Cloud& cloud, const RenderSettings& settings, const Scale& scale);

/// Blocks over a grid's cells, see render_partition. Errors: a picture that becomes too high.
Result<Canvas> draw_partition(const Cloud& grid, const std::vector<PartitionBlock>& blocks,
                              const std::vector<std::uint8_t>& layer,
                              const RenderSettings& settings, const Scale& scale);

/// Diameter of a dot in pixels for `points` dots on a picture, when the settings leave it open.
double dot_size(const RenderSettings& settings, int width, int height, std::size_t points);

}  // namespace curlidar::drawing
