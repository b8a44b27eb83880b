// SPDX-License-Identifier: BSD-3-Clause
// A tiny built-in font for titles and scales.
#pragma once

#include <array>
#include <cstdint>

namespace curlidar::drawing {

inline constexpr int kGlyphWidth = 5, kGlyphHeight = 7;
/// From one character to the next, in font pixels.
inline constexpr int kGlyphAdvance = 6;

/// Rows of a printable ASCII character from the top; bit 4 is the leftmost pixel. Others: a box.
const std::array<std::uint8_t, 7>& glyph(char c);
/// How many pixels the character hangs below the others: its descender.
int glyph_drop(char c);

}  // namespace curlidar::drawing
