// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/splats.hpp"
#include "render/views.hpp"

namespace curlidar::drawing {

namespace {

constexpr float kShading = 1.6f;  // per metre of height

double fitting_extent(const Cloud& cloud) {
  std::vector<double> ranges;
  for (const Vec3& p : cloud.positions) {
    if (is_return(p)) ranges.push_back(std::hypot(p.x, p.y));
  }
  return std::max(1.05 * percentile(ranges, 0.95), 0.5);
}

/// A round step that puts at most a dozen circles into the picture: 10 m for most scans.
double circle_step(double extent) {
  for (const double step : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
    if (extent / step <= (step < 10 ? 3 : 12)) return step;
  }
  return extent / 4;
}

void draw_circles(Canvas& canvas, double pixels_per_metre, double extent) {
  const double x = 0.5 * canvas.width(), y = 0.5 * canvas.height();
  const double step = circle_step(extent);
  const int size = font_scale(canvas.width());
  const double corner = std::hypot(x, y) / pixels_per_metre;
  for (int k = 1; k * step < corner && k < 100; ++k) {
    const double radius = k * step * pixels_per_metre;
    canvas.circle(x, y, radius, size, kFaint, 0.55f);
  }
}

/// Labels lie over the points, along the diagonal to the lower right.
void draw_labels(Canvas& canvas, double pixels_per_metre, double extent) {
  const double step = circle_step(extent);
  const int size = font_scale(canvas.width());
  for (int k = 1; k < 100; ++k) {
    const double offset = k * step * pixels_per_metre * std::sqrt(0.5);
    const int x = static_cast<int>(std::min(0.5 * canvas.width() + offset, 1e6));
    const int y = static_cast<int>(std::min(0.5 * canvas.height() + offset, 1e6));
    if (x > canvas.width() || y > canvas.height()) return;
    canvas.text(x + 2 * size, y, fmt::format("{:g} m", k * step), size, mix(kFaint, kInk, 0.45f));
  }
}

void draw_cross(Canvas& canvas) {
  const double x = 0.5 * canvas.width(), y = 0.5 * canvas.height();
  const double arm = 6.0 * font_scale(canvas.width()), thick = font_scale(canvas.width());
  canvas.line(x - arm, y, x + arm, y, thick, kInk);
  canvas.line(x, y - arm, x, y + arm, thick, kInk);
}

}  // namespace

Canvas draw_birds_eye(const Cloud& cloud, const RenderSettings& settings, const Scale& scale) {
  const int width = static_cast<int>(settings.width);
  const int height = settings.height > 0 ? static_cast<int>(settings.height) : width;
  const double extent = settings.extent_m > 0 ? settings.extent_m : fitting_extent(cloud);
  const double pixels_per_metre = 0.5 * width / extent;
  Canvas canvas(width, height);
  draw_circles(canvas, pixels_per_metre, extent);
  const double size = dot_size(settings, width, height, count_returns(cloud));
  Splats splats(width, height);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.positions[i];
    if (!is_return(p)) continue;
    splats.add(0.5 * width - p.y * pixels_per_metre, 0.5 * height - p.x * pixels_per_metre,
               0.5 * size, static_cast<float>(-p.z), static_cast<std::uint32_t>(i));
  }
  splats.compose(canvas, kShading, [&](std::uint32_t point) { return scale.colour_of(point); });
  draw_labels(canvas, pixels_per_metre, extent);
  draw_cross(canvas);
  draw_title(canvas, settings.title);
  draw_scale(canvas, scale);
  return canvas;
}

}  // namespace curlidar::drawing
