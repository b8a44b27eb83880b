// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/try.hpp"
#include "render/views.hpp"

namespace curlidar::drawing {
namespace {

constexpr int kFewestPixels = 4;  ///< of a cell, so that outlines leave something to see
constexpr int kHighest = 16384;

/// Of blocks with that many layers, and of the layers themselves.
constexpr std::array<Colour, 4> kLayerColours{
    {{0.38f, 0.60f, 0.86f}, {0.95f, 0.62f, 0.25f}, {0.45f, 0.80f, 0.45f}, {0.88f, 0.42f, 0.72f}}};

const Colour& layer_colour(std::uint32_t layer) {
  return kLayerColours[std::min<std::size_t>(layer, kLayerColours.size() - 1)];
}

/// Where cells lie on the picture: stripes of whole columns, the leftmost column of the turn (the
/// largest azimuth) first.
struct Stripes {
  int columns = 0;  ///< of the turn
  int rows = 0;
  int per_stripe = 0;  ///< columns
  int cell = 0;        ///< pixels each way
  int count = 0;
  int gap = 0, top = 0;  ///< between stripes; above the first one

  int x(int column) const { return (columns - 1 - column) % per_stripe * cell; }
  int y(int row, int column) const {
    return top + (columns - 1 - column) / per_stripe * (rows * cell + gap) + row * cell;
  }
  int height() const { return count * (rows * cell + gap); }
};

Stripes lay_out(const Cloud& grid, int width, int top, int gap) {
  Stripes s;
  s.columns = static_cast<int>(grid.width);
  s.rows = static_cast<int>(grid.height);
  s.per_stripe = std::clamp(width / kFewestPixels, 1, s.columns);
  s.count = (s.columns + s.per_stripe - 1) / s.per_stripe;
  s.per_stripe = (s.columns + s.count - 1) / s.count;
  s.cell = std::max(width / s.per_stripe, 1);
  s.gap = gap;
  s.top = top;
  return s;
}

/// 255 where the returns have the colours of their ranges.
using CellNumbers = std::vector<std::uint8_t>;

/// Of each cell, the number of the colour of its block's degree.
CellNumbers degree_numbers(const Cloud& grid, const std::vector<PartitionBlock>& blocks) {
  CellNumbers numbers(grid.size(), 255);
  for (const PartitionBlock& block : blocks) {
    const std::uint64_t row_end =
        std::min<std::uint64_t>(block.row + std::uint64_t{block.rows}, grid.height);
    const std::uint64_t column_end =
        std::min<std::uint64_t>(block.column + std::uint64_t{block.columns}, grid.width);
    for (std::uint64_t row = block.row; row < row_end; ++row) {
      for (std::uint64_t column = block.column; column < column_end; ++column) {
        numbers[row * grid.width + column] =
            static_cast<std::uint8_t>(std::clamp(block.layers, 1u, 4u) - 1);
      }
    }
  }
  return numbers;
}

void draw_cells(Canvas& canvas, const Stripes& s, const Cloud& grid,
                const std::vector<std::uint8_t>& layer, const Scale& scale, bool layers) {
  constexpr float kDimmed = 0.75f;
  for (int row = 0; row < s.rows; ++row) {
    for (int column = 0; column < s.columns; ++column) {
      const auto slot = static_cast<std::size_t>(row) * static_cast<std::size_t>(s.columns) +
                        static_cast<std::size_t>(column);
      Colour colour = kBackground * 0.6f;
      if (is_return(grid.positions[slot])) {
        colour = layers && layer[slot] < 255 ? layer_colour(layer[slot]) * 0.85f
                                             : scale.colour_of(slot) * kDimmed;
      }
      canvas.fill(s.x(column), s.y(row, column), s.cell, s.cell, colour);
    }
  }
}

/// Lines along the upper and left edges of a block's cells; neighbours draw the other edges.
void outline(Canvas& canvas, const Stripes& s, const PartitionBlock& block, View view) {
  const bool several = view != View::degrees && block.layers > 1;
  const Colour& colour = several ? layer_colour(block.layers - 1) : kInk;
  const float opacity = several ? 0.95f : view == View::degrees ? 0.25f : 0.55f;
  const auto row = static_cast<int>(block.row), column = static_cast<int>(block.column);
  const auto rows = static_cast<int>(block.rows), columns = static_cast<int>(block.columns);
  for (int j = column; j < std::min(column + columns, s.columns); ++j) {
    const int y = s.y(row, j);
    for (int x = s.x(j); x < s.x(j) + s.cell; ++x) canvas.blend(x, y, colour, opacity);
  }
  const int leftmost = std::min(column + columns, s.columns) - 1;
  const int bottom = std::min(row + rows, s.rows);
  for (int y = s.y(row, leftmost); y < s.y(bottom - 1, leftmost) + s.cell; ++y) {
    canvas.blend(s.x(leftmost), y, colour, opacity);
  }
}

std::string legend_text(View view, std::uint32_t i) {
  if (view == View::layers) return fmt::format("layer {}", i + 1);
  if (view == View::partition) return fmt::format("block of {} layer{}", i + 1, i == 0 ? "" : "s");
  return fmt::format("degree {}{}", i + 1, i + 1 == kLayerColours.size() ? " or more" : "");
}

void draw_legend(Canvas& canvas, int y, int scale, View view) {
  int x = 4 * scale;
  for (std::uint32_t i = 0; i < kLayerColours.size(); ++i) {
    const Colour colour = view == View::partition && i == 0 ? kInk : layer_colour(i);
    canvas.fill(x, y + 2 * scale, 7 * scale, 7 * scale, colour);
    const std::string text = legend_text(view, i);
    canvas.text(x + 10 * scale, y + 2 * scale, text, scale);
    x += 10 * scale + text_width(text, scale) + 10 * scale;
  }
}

}  // namespace

Result<Canvas> draw_partition(const Cloud& grid, const std::vector<PartitionBlock>& blocks,
                              const std::vector<std::uint8_t>& layer,
                              const RenderSettings& settings, const Scale& scale) {
  const int width = static_cast<int>(settings.width);
  const int strip = strip_height(width);
  const int pixel = font_scale(width);
  const int head = settings.title.empty() ? 0 : strip;
  const Stripes s = lay_out(grid, width, head, strip / 3);
  const bool ranges = settings.view == View::partition;
  const int legend_y = head + s.height();
  const int height = legend_y + strip + (ranges ? strip : 0);
  if (height > kHighest) {
    return Error{
        ErrorCode::invalid_argument,
        fmt::format("render: {} x {} cells make a picture of {} x {} pixels; give a larger "
                    "width",
                    s.rows, s.columns, width, height)};
  }
  Canvas canvas(width, height);
  const bool degrees = settings.view == View::degrees;
  draw_cells(canvas, s, grid, degrees ? degree_numbers(grid, blocks) : layer, scale, !ranges);
  for (const PartitionBlock& block : blocks) {
    if (block.row < grid.height && block.column < grid.width && block.rows > 0 &&
        block.columns > 0) {
      outline(canvas, s, block, settings.view);
    }
  }
  draw_title(canvas, settings.title);
  draw_legend(canvas, legend_y, pixel, settings.view);
  if (ranges) draw_scale(canvas, scale);
  return canvas;
}

}  // namespace curlidar::drawing
