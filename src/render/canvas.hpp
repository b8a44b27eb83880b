// SPDX-License-Identifier: BSD-3-Clause
// A picture being drawn.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "curlidar/render.hpp"
#include "render/colours.hpp"

namespace curlidar::drawing {

/// Pixels with origin in the upper left; drawing outside of it is ignored. Pixel (x, y) covers
/// [x, x + 1) x [y, y + 1).
class Canvas {
 public:
  Canvas(int width, int height, const Colour& colour = kBackground);

  int width() const { return width_; }
  int height() const { return height_; }
  const Colour& at(int x, int y) const { return pixels_[index(x, y)]; }

  void set(int x, int y, const Colour& colour);
  /// Lays a colour of the given opacity over a pixel.
  void blend(int x, int y, const Colour& colour, float opacity);
  void fill(int x, int y, int width, int height, const Colour& colour);
  /// A soft-edged line or circle of the given width in pixels.
  void line(double x0, double y0, double x1, double y1, double width, const Colour& colour,
            float opacity = 1);
  void circle(double x, double y, double radius, double width, const Colour& colour,
              float opacity = 1);
  /// Text with its upper left corner at (x, y), each font pixel scale x scale, with a soft shadow.
  void text(int x, int y, std::string_view text, int scale, const Colour& colour = kInk);

  Image image() const;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  int width_, height_;
  std::vector<Colour> pixels_;
};

/// Width of a text in pixels.
int text_width(std::string_view text, int scale);

}  // namespace curlidar::drawing
