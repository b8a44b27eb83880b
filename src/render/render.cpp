// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/try.hpp"
#include "render/views.hpp"

namespace curlidar {

namespace {

constexpr std::uint32_t kMinSide = 16, kMaxSide = 8192;

Status check(const RenderSettings& settings) {
  const auto side_ok = [](std::uint32_t side) { return side >= kMinSide && side <= kMaxSide; };
  if (!side_ok(settings.width) || (settings.height != 0 && !side_ok(settings.height))) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("render: a picture of {} x {} pixels; give {} to {} each way",
                             settings.width, settings.height, kMinSide, kMaxSide)};
  }
  const auto measure = [](double value) { return std::isfinite(value) && value >= 0; };
  if (!measure(settings.extent_m) || !measure(settings.distance_m) ||
      !measure(settings.point_size_px) || settings.point_size_px > 256 ||
      !std::isfinite(settings.yaw_deg) || !std::isfinite(settings.pitch_deg)) {
    return Error{ErrorCode::invalid_argument,
                 "render: extent, distance, point size (at most 256 px) and camera angles must be "
                 "finite, and none but angles below 0"};
  }
  return {};
}

template <class Value, std::size_t Size>
Result<Value> by_name(std::string_view name, const char* what,
                      const std::array<std::pair<std::string_view, Value>, Size>& known) {
  std::string names;
  for (const auto& [known_name, value] : known) {
    if (name == known_name) return value;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", known_name);
  }
  return Error{ErrorCode::invalid_argument,
               fmt::format("no {} named '{}'; there are {}", what, name, names)};
}

bool shows_blocks(View view) {
  return view == View::partition || view == View::layers || view == View::degrees;
}

/// The same picture of the cloud with its high returns turned into empty slots.
Result<Image> render_below(Cloud cloud, RenderSettings settings,
                           const std::vector<double>& values) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (Vec3& p : cloud.positions) {
    if (p.z > *settings.clip_above_m) p = {kNaN, kNaN, kNaN};
  }
  settings.clip_above_m.reset();
  return render(cloud, settings, values);
}

}  // namespace

Result<View> view_by_name(std::string_view name) {
  return by_name<View, 6>(name, "view",
                          {{{"range-image", View::range_image},
                            {"birds-eye", View::birds_eye},
                            {"perspective", View::perspective},
                            {"partition", View::partition},
                            {"layers", View::layers},
                            {"degrees", View::degrees}}});
}

Result<ColourBy> colour_by_name(std::string_view name) {
  return by_name<ColourBy, 5>(name, "colouring",
                              {{{"range", ColourBy::range},
                                {"height", ColourBy::height},
                                {"intensity", ColourBy::intensity},
                                {"error", ColourBy::error},
                                {"normal", ColourBy::normal}}});
}

Result<Image> render(const Cloud& cloud, const RenderSettings& settings,
                     const std::vector<double>& values) {
  CURLIDAR_TRY(check(settings));
  if (shows_blocks(settings.view)) {
    return Error{ErrorCode::invalid_argument,
                 "render: partition, layers and degrees are views of .curl files, not of clouds"};
  }
  if (settings.clip_above_m) return render_below(cloud, settings, values);
  CURLIDAR_TRY_ASSIGN(scale, drawing::make_scale(cloud, settings, values));
  switch (settings.view) {
    case View::range_image: {
      CURLIDAR_TRY_ASSIGN(canvas, drawing::draw_range_image(cloud, settings, scale));
      return canvas.image();
    }
    case View::birds_eye:
      return drawing::draw_birds_eye(cloud, settings, scale).image();
    default:
      break;
  }
  return drawing::draw_perspective(cloud, settings, scale).image();
}

Result<Image> render_partition(const Cloud& grid, const std::vector<PartitionBlock>& blocks,
                               const std::vector<std::uint8_t>& layer,
                               const RenderSettings& settings) {
  CURLIDAR_TRY(check(settings));
  if (!shows_blocks(settings.view)) {
    return Error{ErrorCode::invalid_argument, "render: this view does not show a partition"};
  }
  const std::uint64_t cells = std::uint64_t{grid.width} * grid.height;
  const bool layer_fits =
      layer.size() == cells || (settings.view == View::degrees && layer.empty());
  if (grid.width < 4 || grid.height == 0 || grid.size() != cells || !layer_fits) {
    return Error{ErrorCode::invalid_argument,
                 "render: a partition needs an organised cloud and a layer for each of its slots"};
  }
  CURLIDAR_TRY_ASSIGN(scale, drawing::make_scale(grid, settings, {}));
  CURLIDAR_TRY_ASSIGN(canvas, drawing::draw_partition(grid, blocks, layer, settings, scale));
  return canvas.image();
}

Image side_by_side(const std::vector<Image>& images) {
  constexpr std::uint32_t kGap = 4;
  Image out;
  for (const Image& image : images) {
    out.width += image.width + (out.width > 0 ? kGap : 0);
    out.height = std::max(out.height, image.height);
  }
  const auto byte = [](float channel) { return static_cast<std::uint8_t>(channel * 255); };
  const drawing::Colour gap = drawing::kFaint;
  out.rgb.resize(static_cast<std::size_t>(out.width) * out.height * 3);
  for (std::size_t i = 0; i < out.rgb.size(); i += 3) {
    out.rgb[i] = byte(gap.r), out.rgb[i + 1] = byte(gap.g), out.rgb[i + 2] = byte(gap.b);
  }
  std::size_t left = 0;
  for (const Image& image : images) {
    for (std::size_t y = 0; y < image.height; ++y) {
      std::copy_n(image.rgb.begin() + static_cast<std::ptrdiff_t>(y * image.width * 3),
                  image.width * 3u,
                  out.rgb.begin() + static_cast<std::ptrdiff_t>((y * out.width + left) * 3));
    }
    left += image.width + kGap;
  }
  return out;
}

}  // namespace curlidar
