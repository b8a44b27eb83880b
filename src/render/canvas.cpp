// SPDX-License-Identifier: BSD-3-Clause
#include "render/canvas.hpp"

#include <algorithm>
#include <cmath>

#include "render/font.hpp"

namespace curlidar::drawing {

namespace {

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255 + 0.5f);
}

/// How much of a pixel at this distance from a stroke's middle the stroke covers, about.
float coverage(double distance, double width) {
  return static_cast<float>(std::clamp(width / 2 + 0.5 - distance, 0.0, 1.0));
}

}  // namespace

Canvas::Canvas(int width, int height, const Colour& colour)
    : width_(width),
      height_(height),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), colour) {}

void Canvas::set(int x, int y, const Colour& colour) {
  if (x >= 0 && y >= 0 && x < width_ && y < height_) pixels_[index(x, y)] = colour;
}

void Canvas::blend(int x, int y, const Colour& colour, float opacity) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_ || opacity <= 0) return;
  Colour& pixel = pixels_[index(x, y)];
  pixel = mix(pixel, colour, std::min(opacity, 1.0f));
}

void Canvas::fill(int x, int y, int width, int height, const Colour& colour) {
  for (int j = y; j < y + height; ++j) {
    for (int i = x; i < x + width; ++i) set(i, j, colour);
  }
}

void Canvas::line(double x0, double y0, double x1, double y1, double width, const Colour& colour,
                  float opacity) {
  const double dx = x1 - x0, dy = y1 - y0;
  const double length2 = std::max(dx * dx + dy * dy, 1e-12);
  const double margin = width / 2 + 1;
  const auto low = [&](double a, double b) {
    return static_cast<int>(std::floor(std::min(a, b) - margin));
  };
  const auto high = [&](double a, double b) {
    return static_cast<int>(std::ceil(std::max(a, b) + margin));
  };
  for (int y = std::max(0, low(y0, y1)); y <= std::min(height_ - 1, high(y0, y1)); ++y) {
    for (int x = std::max(0, low(x0, x1)); x <= std::min(width_ - 1, high(x0, x1)); ++x) {
      const double px = x + 0.5 - x0, py = y + 0.5 - y0;
      const double along = std::clamp((px * dx + py * dy) / length2, 0.0, 1.0);
      const double distance = std::hypot(px - along * dx, py - along * dy);
      blend(x, y, colour, opacity * coverage(distance, width));
    }
  }
}

void Canvas::circle(double x, double y, double radius, double width, const Colour& colour,
                    float opacity) {
  for (int j = 0; j < height_; ++j) {
    const double py = j + 0.5 - y;
    if (std::abs(py) > radius + width + 1) continue;
    for (int i = 0; i < width_; ++i) {
      const double distance = std::abs(std::hypot(i + 0.5 - x, py) - radius);
      if (distance < width / 2 + 1) blend(i, j, colour, opacity * coverage(distance, width));
    }
  }
}

void Canvas::text(int x, int y, std::string_view text, int scale, const Colour& colour) {
  const auto each_pixel = [&](const auto& paint) {
    for (std::size_t k = 0; k < text.size(); ++k) {
      const auto& rows = glyph(text[k]);
      const int top = y + glyph_drop(text[k]) * scale;
      const int left = x + static_cast<int>(k) * kGlyphAdvance * scale;
      for (int j = 0; j < kGlyphHeight * scale; ++j) {
        for (int i = 0; i < kGlyphWidth * scale; ++i) {
          if (rows[static_cast<std::size_t>(j / scale)] >> (4 - i / scale) & 1)
            paint(left + i, top + j);
        }
      }
    }
  };
  each_pixel([&](int px, int py) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) blend(px + i, py + j, kBackground, 0.35f);
    }
  });
  each_pixel([&](int px, int py) { set(px, py, colour); });
}

Image Canvas::image() const {
  Image image;
  image.width = static_cast<std::uint32_t>(width_);
  image.height = static_cast<std::uint32_t>(height_);
  image.rgb.reserve(pixels_.size() * 3);
  for (const Colour& pixel : pixels_) {
    for (const float channel : {pixel.r, pixel.g, pixel.b}) image.rgb.push_back(to_byte(channel));
  }
  return image;
}

int text_width(std::string_view text, int scale) {
  return text.empty()
             ? 0
             : (static_cast<int>(text.size()) * kGlyphAdvance - (kGlyphAdvance - kGlyphWidth)) *
                   scale;
}

}  // namespace curlidar::drawing
