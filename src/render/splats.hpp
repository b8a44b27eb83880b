// SPDX-License-Identifier: BSD-3-Clause
// Round, shaded dots with a depth buffer, at twice the picture's resolution.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "render/canvas.hpp"

namespace curlidar::drawing {

/// Collects dots, keeps the nearest in every sub-pixel, and lays the result over a canvas.
class Splats {
 public:
  /// Size of the picture in pixels.
  Splats(int width, int height);

  /// A disc around (x, y), radius in pixels, of the given point. `depth` is any measure that grows
  /// away from the viewer; its differences decide the shading. Where depths are equal, the
  /// first dot stays.
  void add(double x, double y, double radius, float depth, std::uint32_t point);

  /// Eye-dome lighting (Boucheny 2009): darkens what lies behind its neighbours on the screen, by
  /// `strength` for each unit of depth, then averages sub-pixels over the canvas.
  void compose(Canvas& canvas, float strength,
               const std::function<Colour(std::uint32_t point)>& colour_of) const;

 private:
  static constexpr int kSamples = 2;  ///< sub-pixels along each side of a pixel

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  float shade(int x, int y, float strength) const;

  int width_, height_;  ///< in sub-pixels
  std::vector<float> depth_;
  std::vector<std::uint32_t> point_;
};

}  // namespace curlidar::drawing
