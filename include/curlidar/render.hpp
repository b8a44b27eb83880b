// SPDX-License-Identifier: BSD-3-Clause
// Pictures of clouds, for people to look at.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// 8-bit RGB, row by row from the top.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3
};

enum class View { range_image, birds_eye, perspective };
enum class ColourBy { range, height, intensity, error };
Result<View> view_by_name(std::string_view name);           ///< "range-image", "birds-eye", "perspective"
Result<ColourBy> colour_by_name(std::string_view name);     ///< "range", "height", "intensity", "error"

struct RenderSettings {
  View view = View::perspective;
  ColourBy colour = ColourBy::height;
  std::uint32_t width = 1280, height = 0;  ///< height 0: what suits the view
  /// Values mapped to the two ends of the colour map; by default the 2nd and 98th percentile, for
  /// errors 0 and the 98th.
  std::optional<double> value_min, value_max;
  double extent_m = 0;     ///< half width of the bird's-eye view; 0 = fits the 95th percentile
  double yaw_deg = -145, pitch_deg = 28;  ///< perspective camera, orbiting the sensor
  double distance_m = 0;                  ///< of that camera; 0 = fits the cloud
  double point_size_px = 0;               ///< 0 = by density
  /// Returns higher than this are left out: it takes the ceiling off a room.
  std::optional<double> clip_above_m;
  std::string title;                      ///< drawn in the corner if not empty
};

/// Draws the returns of a cloud. For ColourBy::error `values` holds one value per slot (metres);
/// otherwise it may be empty. Range images show organised clouds row by row and others by the
/// rings that detect_sensor finds, as seen from the sensor; bird's-eye views have forward up
/// and circles every 10 m. Errors: no return, sides outside 16 .. 8192 pixels, missing values.
/// Deterministic. About 0.2 s for 120 k points and a million pixels.
Result<Image> render(const Cloud& cloud, const RenderSettings& settings,
                     const std::vector<double>& values = {});

/// Pictures of equal height side by side with a thin gap.
Image side_by_side(const std::vector<Image>& images);

/// Atomic; "-" is standard output.
Status write_png(const std::string& path, const Image& image);

}  // namespace curlidar
