// SPDX-License-Identifier: BSD-3-Clause
#include "render/splats.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace curlidar::drawing {

namespace {

constexpr float kEmpty = std::numeric_limits<float>::infinity();
/// A step in depth of more than this darkens no further: silhouettes stay thin lines.
constexpr float kMaxStep = 1;

}  // namespace

Splats::Splats(int width, int height)
    : width_(width * kSamples),
      height_(height * kSamples),
      depth_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), kEmpty),
      point_(depth_.size()) {}

void Splats::add(double x, double y, double radius, float depth, std::uint32_t point) {
  x *= kSamples;
  y *= kSamples;
  radius = std::max(radius * kSamples, 0.5);
  // Dots far outside the picture must not reach the conversion to int.
  if (!(x > -radius && y > -radius && x < width_ + radius && y < height_ + radius)) return;
  const int left = std::max(0, static_cast<int>(std::floor(x - radius)));
  const int right = std::min(width_ - 1, static_cast<int>(std::floor(x + radius)));
  const int top = std::max(0, static_cast<int>(std::floor(y - radius)));
  const int bottom = std::min(height_ - 1, static_cast<int>(std::floor(y + radius)));
  const double reach2 = radius * radius;
  for (int j = top; j <= bottom; ++j) {
    for (int i = left; i <= right; ++i) {
      const double dx = i + 0.5 - x, dy = j + 0.5 - y;
      const bool centre = i == static_cast<int>(x) && j == static_cast<int>(y);
      if (dx * dx + dy * dy > reach2 && !centre) continue;
      const std::size_t at = index(i, j);
      if (depth < depth_[at]) depth_[at] = depth, point_[at] = point;
    }
  }
}

float Splats::shade(int x, int y, float strength) const {
  constexpr std::array<std::array<int, 2>, 8> kRing{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
  const float own = depth_[index(x, y)];
  float sum = 0;
  for (const auto& [dx, dy] : kRing) {
    for (const int reach : {2, 4}) {
      const int i = x + dx * reach, j = y + dy * reach;
      if (i < 0 || j < 0 || i >= width_ || j >= height_) continue;
      const float other = depth_[index(i, j)];
      if (other < own) sum += std::min(own - other, kMaxStep / strength);
    }
  }
  return std::exp(-strength * sum / 16);
}

void Splats::compose(Canvas& canvas, float strength,
                     const std::function<Colour(std::uint32_t)>& colour_of) const {
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      Colour sum{};
      int covered = 0;
      for (int sample = 0; sample < kSamples * kSamples; ++sample) {
        const int i = x * kSamples + sample % kSamples, j = y * kSamples + sample / kSamples;
        if (depth_[index(i, j)] == kEmpty) continue;
        sum = sum + colour_of(point_[index(i, j)]) * shade(i, j, strength);
        ++covered;
      }
      if (covered == 0) continue;
      const float share = static_cast<float>(covered) / (kSamples * kSamples);
      canvas.blend(x, y, sum * (1 / static_cast<float>(covered)), share);
    }
  }
}

}  // namespace curlidar::drawing
