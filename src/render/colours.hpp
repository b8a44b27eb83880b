// SPDX-License-Identifier: BSD-3-Clause
// Colours and the maps from values to them.
#pragma once

#include <cstdint>

namespace curlidar::drawing {

/// Red, green, blue in [0, 1], as displayed (sRGB).
struct Colour {
  float r = 0, g = 0, b = 0;

  friend Colour operator*(const Colour& c, float s) { return {c.r * s, c.g * s, c.b * s}; }
  friend Colour operator+(const Colour& c, const Colour& d) {
    return {c.r + d.r, c.g + d.g, c.b + d.b};
  }
  friend bool operator==(const Colour&, const Colour&) = default;
};

inline Colour mix(const Colour& a, const Colour& b, float share) {
  return a * (1 - share) + b * share;
}

/// The colour of a share in [0, 1] (clamped; NaN is grey) between violet-blue and warm yellow.
/// Lightness rises all the way, and even the low end shows on a dark background.
Colour map_value(double share);
/// For errors: from slate over red to bright yellow, so that only what is wrong glows.
Colour map_error(double share);

inline constexpr Colour kBackground{0.055f, 0.063f, 0.082f};
inline constexpr Colour kInk{0.90f, 0.92f, 0.95f};
inline constexpr Colour kFaint{0.30f, 0.34f, 0.41f};

}  // namespace curlidar::drawing
