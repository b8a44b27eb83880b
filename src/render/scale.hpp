// SPDX-License-Identifier: BSD-3-Clause
// What colours mean: the value of every return, its range, and the bar that shows it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "curlidar/render.hpp"
#include "render/canvas.hpp"

namespace curlidar::drawing {

/// The values of a cloud's slots and how they become colours.
struct Scale {
  std::vector<double> values;  ///< one per slot
  double low = 0, high = 1;    ///< low < high
  std::string label;           ///< with its unit
  bool error = false;
  std::vector<Colour> colours;  ///< of the slots themselves, not from values; empty: from those

  Colour colour(double share) const { return error ? map_error(share) : map_value(share); }
  Colour colour_of(std::size_t slot) const {
    return colours.empty() ? colour((values[slot] - low) / (high - low)) : colours[slot];
  }
};

/// Values by the settings. Errors: no return, a missing intensity, wrong number of error values.
Result<Scale> make_scale(const Cloud& cloud, const RenderSettings& settings,
                         const std::vector<double>& values);

/// Pixels of a font pixel, by the size of the picture.
int font_scale(int picture_width);
/// Height of the strip that a line of text or the bar needs.
int strip_height(int picture_width);
/// The title in the upper left corner.
void draw_title(Canvas& canvas, const std::string& title);
/// The bar with its ends and label in the lower left corner.
void draw_scale(Canvas& canvas, const Scale& scale);

}  // namespace curlidar::drawing
