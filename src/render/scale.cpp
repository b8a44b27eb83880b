// SPDX-License-Identifier: BSD-3-Clause
#include "render/scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/font.hpp"

namespace curlidar::drawing {

namespace {

Result<std::vector<double>> values_of(const Cloud& cloud, ColourBy colour,
                                      const std::vector<double>& given) {
  std::vector<double> values(cloud.size());
  if (colour == ColourBy::error) {
    if (given.size() != cloud.size()) {
      return Error{
          ErrorCode::invalid_argument,
          fmt::format("render: colour by error needs one value per point: {} values for {} "
                      "points",
                      given.size(), cloud.size())};
    }
    return given;
  }
  if (colour == ColourBy::intensity) {
    const Attribute* intensity = cloud.find("intensity");
    if (intensity == nullptr) intensity = cloud.find("reflectivity");
    if (intensity == nullptr) {
      return Error{ErrorCode::not_found,
                   "render: the cloud has no attribute 'intensity' or 'reflectivity'; colour by "
                   "range or height"};
    }
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = intensity->as_double(i);
    return values;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = colour == ColourBy::range ? norm(cloud.positions[i]) : cloud.positions[i].z;
  }
  return values;
}

/// Opposite normals, and those of one wall from both sides, look alike.
Result<Scale> normal_scale(const Cloud& cloud) {
  const Attribute* parts[] = {cloud.find("normal_x"), cloud.find("normal_y"),
                              cloud.find("normal_z")};
  if (parts[0] == nullptr || parts[1] == nullptr || parts[2] == nullptr) {
    return Error{ErrorCode::not_found,
                 "render: the cloud has no attributes normal_x, normal_y and normal_z; colour by "
                 "range or height"};
  }
  if (count_returns(cloud) == 0) {
    return Error{ErrorCode::invalid_argument, "render: the cloud has no return; nothing to draw"};
  }
  Scale scale;
  scale.label = "normal: |x| red, |y| green, |z| blue";
  scale.colours.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto part = [&](const Attribute* attribute) {
      const double value = std::abs(attribute->as_double(i));
      return std::isnan(value) ? 0.5f : static_cast<float>(0.15 + 0.8 * std::min(value, 1.0));
    };
    scale.colours.push_back({part(parts[0]), part(parts[1]), part(parts[2])});
  }
  return scale;
}

const char* label_of(ColourBy colour) {
  switch (colour) {
    case ColourBy::range:
      return "range [m]";
    case ColourBy::height:
      return "height [m]";
    case ColourBy::intensity:
      return "intensity";
    case ColourBy::error:
    case ColourBy::normal:
      break;
  }
  return "error [m]";
}

/// An end of the bar, as precisely as the bar's span asks for.
std::string number(double value, double span) {
  if (std::abs(value) >= 1e5 || span < 1e-3) return fmt::format("{:.2e}", value);
  const int decimals = span >= 100 ? 0 : span >= 1 ? 1 : span >= 0.1 ? 2 : 4;
  return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

Result<Scale> make_scale(const Cloud& cloud, const RenderSettings& settings,
                         const std::vector<double>& given) {
  if (settings.colour == ColourBy::normal) return normal_scale(cloud);
  auto values = values_of(cloud, settings.colour, given);
  if (!values) return values.error();
  Scale scale;
  scale.values = std::move(*values);
  scale.label = label_of(settings.colour);
  scale.error = settings.colour == ColourBy::error;
  std::vector<double> finite;
  finite.reserve(cloud.size());
  std::size_t returns = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_return(cloud.positions[i])) continue;
    ++returns;
    if (std::isfinite(scale.values[i])) finite.push_back(scale.values[i]);
  }
  if (returns == 0) {
    return Error{ErrorCode::invalid_argument, "render: the cloud has no return; nothing to draw"};
  }
  if (finite.empty()) finite.push_back(0);
  scale.low = settings.value_min.value_or(scale.error ? 0 : percentile(finite, 0.02));
  scale.high = settings.value_max.value_or(percentile(finite, 0.98));
  if (!std::isfinite(scale.low) || !std::isfinite(scale.high)) {
    return Error{ErrorCode::invalid_argument, "render: give finite ends of the colour scale"};
  }
  if (!(scale.low < scale.high)) {
    if (settings.value_min && settings.value_max) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("render: the colour scale runs from {} to {}; give min < max",
                               scale.low, scale.high)};
    }
    // All values alike: any width does, but the given end must stay.
    const double width = std::max(1.0, std::abs(scale.low));
    if (settings.value_max) {
      scale.low = scale.high - width;
    } else {
      scale.high = scale.low + width;
    }
  }
  return scale;
}

int font_scale(int picture_width) {
  return std::clamp((picture_width + 1000) / 800, 1, 6);
}

int strip_height(int picture_width) {
  return (kGlyphHeight + 8) * font_scale(picture_width);
}

void draw_title(Canvas& canvas, const std::string& title) {
  if (title.empty()) return;
  const int scale = font_scale(canvas.width());
  canvas.text(5 * scale, 4 * scale, title, scale);
}

void draw_scale(Canvas& canvas, const Scale& scale) {
  const int size = font_scale(canvas.width());
  const int y = canvas.height() - (kGlyphHeight + 4) * size;
  int x = 5 * size;
  const auto write = [&](const std::string& text) {
    canvas.text(x, y, text, size);
    x += text_width(text, size) + 4 * size;
  };
  const double span = scale.high - scale.low;
  write(scale.label);
  if (!scale.colours.empty()) return;
  write(number(scale.low, span));
  const int width = std::min(80 * size, canvas.width() / 4);
  for (int i = 0; i < width; ++i) {
    canvas.fill(x + i, y, 1, kGlyphHeight * size, scale.colour(i / std::max(1.0, width - 1.0)));
  }
  x += width + 4 * size;
  write(number(scale.high, span));
}

}  // namespace curlidar::drawing
