// SPDX-License-Identifier: BSD-3-Clause
#include "common_map_pictures.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common_options.hpp"

namespace curlidar::app {
namespace {

/// What all but the outermost hundredths of the points lie between.
struct Span {
  double low, high;
  double middle() const { return 0.5 * (low + high); }
  double length() const { return high - low; }
};

Span span_of(const Cloud& cloud, double Vec3::*axis) {
  std::vector<double> values;
  for (const Vec3& p : cloud.positions) {
    if (is_return(p)) values.push_back(p.*axis);
  }
  return {percentile(values, 0.005), percentile(values, 0.995)};
}

void parse_picture_size(const std::string& text, RenderSettings& settings) {
  const std::size_t cross = text.find('x');
  const std::string height = cross == std::string::npos ? "0" : text.substr(cross + 1);
  if (CLI::detail::lexical_cast(text.substr(0, cross), settings.width) &&
      CLI::detail::lexical_cast(height, settings.height) && settings.width > 0) {
    return;
  }
  usage_error(
      fmt::format("--size '{}': give WIDTHxHEIGHT in pixels, height 0 for what suits", text));
}

}  // namespace

Image map_picture(Cloud cloud, RenderSettings settings, const std::string& size) {
  parse_picture_size(size, settings);
  if (cloud.size() == 0) {
    throw Failure({ErrorCode::invalid_argument, "the map has no surface to draw"}, kExitInput);
  }
  const Span x = span_of(cloud, &Vec3::x), y = span_of(cloud, &Vec3::y);
  for (Vec3& p : cloud.positions) p = p - Vec3{x.middle(), y.middle(), 0};
  if (settings.view == View::birds_eye) {
    // Forward (x) is up: the picture's width is the map's along y.
    constexpr double kMargin = 1.04, kLeast_m = 1;
    const double across = std::max(kLeast_m, y.length()), along = std::max(kLeast_m, x.length());
    if (settings.height == 0) {
      const double height = settings.width * std::clamp(along / across, 0.4, 2.0);
      settings.height = static_cast<std::uint32_t>(std::min(std::round(height), 8192.0));
    }
    const double per_height = along * settings.width / settings.height;
    if (settings.extent_m == 0) settings.extent_m = 0.5 * kMargin * std::max(across, per_height);
  }
  std::vector<double> values;
  if (settings.colour == ColourBy::error) {
    const Attribute* error = cloud.find("error");
    for (std::size_t i = 0; error != nullptr && i < cloud.size(); ++i) {
      values.push_back(error->as_double(i));
    }
  }
  return need(render(cloud, settings, values));
}

}  // namespace curlidar::app
