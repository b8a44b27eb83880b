// SPDX-License-Identifier: BSD-3-Clause
#include "common_pictures.hpp"

#include <fmt/format.h>

namespace curlidar::app {

void add_picture_options(CLI::App& app, RenderSettings& render, std::string& size,
                         const std::string& middle, const std::string& height_of) {
  app.add_option("--size", size, "Pixels; height 0 = what suits the view")
      ->type_name("WxH")
      ->capture_default_str();
  app.add_option("--min-value", render.value_min,
                 "Value at the lower end of the colours; default the 2nd percentile");
  app.add_option("--max-value", render.value_max,
                 "Value at the upper end; default the 98th percentile");
  app.add_option("--extent", render.extent_m, "Half width of the view from above, metres; 0 = fits")
      ->capture_default_str();
  app.add_option("--yaw", render.yaw_deg, fmt::format("Camera around {}, degrees", middle))
      ->capture_default_str();
  app.add_option("--pitch", render.pitch_deg, "Camera above the horizon, degrees")
      ->capture_default_str();
  app.add_option("--distance", render.distance_m, "Camera distance, metres; 0 = fits")
      ->capture_default_str();
  app.add_option("--point-size", render.point_size_px, "Pixels; 0 = by density")
      ->capture_default_str();
  app.add_option("--clip-above", render.clip_above_m,
                 fmt::format("Leave out points higher than this above {}, metres: the ceiling of "
                             "a room",
                             height_of));
  app.add_option("--title", render.title, "Text in the corner");
}

}  // namespace curlidar::app
