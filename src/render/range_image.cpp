// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "base/try.hpp"
#include "curlidar/sensor.hpp"
#include "render/views.hpp"

namespace curlidar::drawing {

namespace {

constexpr std::uint32_t kNone = 0xffffffff;

/// Which slot is shown in every cell.
struct Grid {
  std::size_t rows = 0, columns = 0;
  std::vector<std::uint32_t> slot;

  Grid(std::size_t rows_, std::size_t columns_)
      : rows(rows_), columns(columns_), slot(rows_ * columns_, kNone) {}
};

/// Mean of `value` over the returns of each row of an organised cloud; NaN for empty rows.
double mean_elevation(const Cloud& cloud, std::size_t row) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t j = 0; j < cloud.width; ++j) {
    const Vec3& p = cloud.positions[row * cloud.width + j];
    if (is_return(p)) sum += elevation_of(p), ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
}

bool rows_run_upwards(const Cloud& cloud) {
  std::optional<double> first, last;
  for (std::size_t row = 0; row < cloud.height; ++row) {
    const double elevation = mean_elevation(cloud, row);
    if (std::isnan(elevation)) continue;
    if (!first) first = elevation;
    last = elevation;
  }
  return first && *first < *last;
}

/// Whether azimuth grows (turns left) from column to column, as most neighbours have it.
bool columns_run_leftwards(const Cloud& cloud) {
  std::ptrdiff_t balance = 0;
  for (std::size_t row = 0; row < cloud.height; ++row) {
    for (std::size_t j = 0; j + 1 < cloud.width; ++j) {
      const Vec3& a = cloud.positions[row * cloud.width + j];
      const Vec3& b = cloud.positions[row * cloud.width + j + 1];
      if (!is_return(a) || !is_return(b)) continue;
      const double turn = a.x * b.y - a.y * b.x;
      balance += turn > 0 ? 1 : turn < 0 ? -1 : 0;
    }
  }
  return balance > 0;
}

Grid grid_of_organised(const Cloud& cloud) {
  Grid grid(cloud.height, cloud.width);
  const bool flip_rows = rows_run_upwards(cloud), flip_columns = columns_run_leftwards(cloud);
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const std::size_t row = flip_rows ? grid.rows - 1 - i : i;
      const std::size_t column = flip_columns ? grid.columns - 1 - j : j;
      const std::size_t slot = row * grid.columns + column;
      if (is_return(cloud.positions[slot])) {
        grid.slot[i * grid.columns + j] = static_cast<std::uint32_t>(slot);
      }
    }
  }
  return grid;
}

/// Rows by detected ring, columns by azimuth: the view to the back, left, front, right, back.
Result<Grid> grid_of_unorganised(const Cloud& cloud, std::size_t max_columns) {
  CURLIDAR_TRY_ASSIGN(detection, detect_sensor(cloud));
  const std::vector<std::uint16_t>& row_of = detection.ring_of_point;
  const std::size_t rows = detection.sensor.rings.size();
  std::vector<std::size_t> filled(rows);
  for (const std::uint16_t row : row_of) {
    if (row != kNoRing) ++filled[row];
  }
  const std::size_t columns =
      std::clamp<std::size_t>(*std::max_element(filled.begin(), filled.end()),
                              std::min<std::size_t>(64, max_columns), max_columns);
  Grid grid(rows, columns);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (row_of[i] == kNoRing) continue;
    const double turn =
        (std::numbers::pi - azimuth_of(cloud.positions[i])) / (2 * std::numbers::pi);
    const auto column = std::min(
        static_cast<std::size_t>(std::max(0.0, turn) * static_cast<double>(columns)), columns - 1);
    std::uint32_t& slot = grid.slot[row_of[i] * columns + column];
    if (slot == kNone || norm(cloud.positions[i]) < norm(cloud.positions[slot])) {
      slot = static_cast<std::uint32_t>(i);
    }
  }
  return grid;
}

Result<Grid> make_grid(const Cloud& cloud, std::size_t max_columns) {
  if (cloud.organised()) return grid_of_organised(cloud);
  return grid_of_unorganised(cloud, max_columns);
}

/// The nearest return of the cells that fall on pixel (x, y) of a width x height picture.
std::uint32_t nearest_on_pixel(const Grid& grid, const Cloud& cloud, int x, int y, int width,
                               int height) {
  const auto from = [](int pixel, int pixels, std::size_t cells) {
    return static_cast<std::size_t>(pixel) * cells / static_cast<std::size_t>(pixels);
  };
  const std::size_t i0 = from(y, height, grid.rows), j0 = from(x, width, grid.columns);
  const std::size_t i1 = std::max(i0 + 1, from(y + 1, height, grid.rows));
  const std::size_t j1 = std::max(j0 + 1, from(x + 1, width, grid.columns));
  std::uint32_t nearest = kNone;
  double range = std::numeric_limits<double>::infinity();
  for (std::size_t i = i0; i < i1; ++i) {
    for (std::size_t j = j0; j < j1; ++j) {
      const std::uint32_t slot = grid.slot[i * grid.columns + j];
      if (slot == kNone || norm(cloud.positions[slot]) >= range) continue;
      nearest = slot;
      range = norm(cloud.positions[slot]);
    }
  }
  return nearest;
}

}  // namespace

Result<Canvas> draw_range_image(const Cloud& cloud, const RenderSettings& settings,
                                const Scale& scale) {
  const int width = static_cast<int>(settings.width);
  CURLIDAR_TRY_ASSIGN(grid, make_grid(cloud, settings.width));
  const int strip = strip_height(width);
  const int head = settings.title.empty() ? 0 : strip;
  int height = 0;
  if (settings.height > 0) {
    height = std::max(1, static_cast<int>(settings.height) - head - strip);
  } else {
    const int rows = static_cast<int>(std::min<std::size_t>(grid.rows, 8192));
    const int tall = std::max(1, static_cast<int>(std::lround(0.25 * width / rows)));
    height = std::min(rows * tall, width);
  }
  Canvas canvas(width, head + height + strip);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint32_t slot = nearest_on_pixel(grid, cloud, x, y, width, height);
      canvas.set(x, head + y, slot == kNone ? kBackground * 0.6f : scale.colour_of(slot));
    }
  }
  draw_title(canvas, settings.title);
  draw_scale(canvas, scale);
  return canvas;
}

}  // namespace curlidar::drawing
