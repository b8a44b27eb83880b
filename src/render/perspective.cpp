// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/splats.hpp"
#include "render/views.hpp"

namespace curlidar::drawing {

namespace {

constexpr double kHalfView = 24 * std::numbers::pi / 180;  // half of the horizontal field of view
constexpr double kNear = 0.05;                             // metres before the camera
constexpr float kShading = 14;                             // per octave of depth

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

/// A pinhole camera; pixels right and down.
class Camera {
 public:
  Camera(const Vec3& target, double yaw, double pitch, double distance, int width, int height)
      : forward_(direction_of(pitch, yaw) * -1),
        right_{-std::sin(yaw), std::cos(yaw), 0},
        up_(cross(right_, forward_)),
        eye_(target - forward_ * distance),
        focal_(0.5 * width / std::tan(kHalfView)),
        centre_x_(0.5 * width),
        centre_y_(0.5 * height) {}

  /// False behind the camera.
  bool project(const Vec3& p, double& x, double& y, double& depth) const {
    const Vec3 seen = p - eye_;
    depth = dot(seen, forward_);
    if (depth < kNear) return false;
    x = centre_x_ + focal_ * dot(seen, right_) / depth;
    y = centre_y_ - focal_ * dot(seen, up_) / depth;
    return true;
  }

 private:
  Vec3 forward_, right_, up_, eye_;
  double focal_, centre_x_, centre_y_;
};

/// A distance from which the bulk of the cloud fills the picture.
double fitting_distance(const Cloud& cloud) {
  std::vector<double> ranges;
  for (const Vec3& p : cloud.positions) {
    if (is_return(p)) ranges.push_back(norm(p));
  }
  return 2.3 * percentile(ranges, 0.8) + 0.5;
}

double median_height(const Cloud& cloud) {
  std::vector<double> heights;
  for (const Vec3& p : cloud.positions) {
    if (is_return(p)) heights.push_back(p.z);
  }
  return percentile(heights, 0.5);
}

/// A sky that fades towards the ground.
void paint_backdrop(Canvas& canvas) {
  for (int y = 0; y < canvas.height(); ++y) {
    const float share = static_cast<float>(y) / static_cast<float>(canvas.height());
    const Colour colour = mix(kBackground * 1.5f, kBackground * 0.8f, share);
    canvas.fill(0, y, canvas.width(), 1, colour);
  }
}

}  // namespace

double dot_size(const RenderSettings& settings, int width, int height, std::size_t points) {
  if (settings.point_size_px > 0) return settings.point_size_px;
  const double area = static_cast<double>(width) * height;
  return std::clamp(0.62 * std::sqrt(area / static_cast<double>(points)), 1.1, 5.0);
}

Canvas draw_perspective(const Cloud& cloud, const RenderSettings& settings, const Scale& scale) {
  const int width = static_cast<int>(settings.width);
  const int height = settings.height > 0 ? static_cast<int>(settings.height) : width * 9 / 16;
  const double distance = settings.distance_m > 0 ? settings.distance_m : fitting_distance(cloud);
  const Camera camera({0, 0, median_height(cloud)}, radians(settings.yaw_deg),
                      radians(settings.pitch_deg), distance, width, height);
  const double size = dot_size(settings, width, height, count_returns(cloud));
  Splats splats(width, height);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    double x = 0, y = 0, depth = 0;
    if (!is_return(cloud.positions[i]) || !camera.project(cloud.positions[i], x, y, depth))
      continue;
    const double nearness = std::clamp(distance / depth, 0.55, 2.5);
    splats.add(x, y, 0.5 * size * nearness, static_cast<float>(std::log2(depth)),
               static_cast<std::uint32_t>(i));
  }
  Canvas canvas(width, height);
  paint_backdrop(canvas);
  splats.compose(canvas, kShading, [&](std::uint32_t point) { return scale.colour_of(point); });
  draw_title(canvas, settings.title);
  draw_scale(canvas, scale);
  return canvas;
}

}  // namespace curlidar::drawing
