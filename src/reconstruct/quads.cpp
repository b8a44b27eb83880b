// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/quads.hpp"

#include <cmath>

#include "base/parallel.hpp"
#include "reconstruct/normals.hpp"

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
/// Sides of the quads, radians: small enough that few surfaces are missed between their corners.
constexpr double kQuadAngle = 0.45 * std::numbers::pi / 180;

/// The planes at one row of corners.
std::vector<Plane> planes_of_row(const ScanView& view, const Sphere& sphere, std::size_t row) {
  std::vector<Sightline> lines(sphere.columns);
  for (std::size_t j = 0; j < lines.size(); ++j) {
    lines[j].direction = sphere.direction(static_cast<double>(row), static_cast<double>(j));
  }
  std::vector<Vec3> points(lines.size());
  std::vector<float> confidence(lines.size());
  view.look(lines, points, confidence, 1);
  const std::vector<Vec3> normals = normals_at(view, points, 1);
  std::vector<Plane> planes(lines.size());
  for (std::size_t j = 0; j < lines.size(); ++j) {
    const double range = norm(points[j]);
    if (!(std::isfinite(range) && range > 0)) continue;
    // A surface that does not tell its slant is taken as seen straight.
    const Vec3 normal = std::isnan(normals[j].x) ? points[j] * (-1 / range) : normals[j];
    const double cosine = std::max(-dot(normal, points[j]) / range, kLeastCosine);
    planes[j] = {normal, range * cosine};
  }
  return planes;
}

}  // namespace

Sphere sphere_of(std::span<const Vec3> returns) {
  // Beams may end a step of rows outside of the outermost returns.
  constexpr double kMargin = 3 * std::numbers::pi / 180;
  double low = std::numbers::pi / 2, high = -low;
  for (const Vec3& p : returns) {
    low = std::min(low, elevation_of(p));
    high = std::max(high, elevation_of(p));
  }
  Sphere sphere;
  if (low > high) return sphere;
  low = std::max(low - kMargin, -std::numbers::pi / 2);
  high = std::min(high + kMargin, std::numbers::pi / 2);
  sphere.top = high;
  sphere.rows = static_cast<std::size_t>(std::ceil((high - low) / kQuadAngle));
  sphere.columns = static_cast<std::size_t>(std::ceil(kTurn / kQuadAngle));
  sphere.row_angle = (high - low) / static_cast<double>(sphere.rows);
  sphere.column_angle = kTurn / static_cast<double>(sphere.columns);
  return sphere;
}

double area_at(const Quad& quad, const Vec3& direction, const std::array<double, 4>& weights,
               double range) {
  constexpr double kOff_m = 0.05, kOffShare = 0.05;    // from any plane: another surface
  constexpr double kSame_m = 0.01, kSameShare = 0.01;  // farther than from the nearest plane
  std::array<double, 4> off{};
  double nearest = kOff_m + kOffShare * range;
  for (std::size_t k = 0; k < off.size(); ++k) {
    const bool exists = quad.planes[k].exists();
    off[k] = exists ? std::abs(quad.planes[k].range(direction) - range) : 1e300;
    nearest = std::min(nearest, off[k]);
  }
  double sum = 0, weight = 0;
  for (std::size_t k = 0; k < off.size(); ++k) {
    if (off[k] > nearest + kSame_m + kSameShare * range) continue;
    const double w = weights[k] + 1e-3;
    sum += w * quad.planes[k].area(direction);
    weight += w;
  }
  return weight > 0 ? sum / weight : range * range;
}

double largest_area(const Quad& quad, const Vec3& direction) {
  double largest = 0;
  for (const Plane& plane : quad.planes) {
    if (plane.exists()) largest = std::max(largest, plane.area(direction));
  }
  return largest;
}

std::array<double, 2> lengths_of(const Quad& quad, const Sphere& sphere) {
  const auto row = static_cast<double>(quad.row), column = static_cast<double>(quad.column);
  double height = 0, width = 0;
  for (const Plane& plane : quad.planes) {
    if (!plane.exists()) continue;
    const auto at = [&](double down, double right) {
      const Vec3 direction = sphere.direction(row + down, column + right);
      return direction * plane.range(direction);
    };
    height = std::max(height, norm(at(0, 0.5) - at(1, 0.5)));
    width = std::max(width, norm(at(0.5, 0) - at(0.5, 1)));
  }
  return {height, width};
}

CornerPlanes::CornerPlanes(const ScanView& view, const Sphere& sphere,
                           const ProgressCallback& progress)
    : rows_(sphere.rows == 0 ? 0 : sphere.rows + 1) {
  constexpr std::size_t kBatch = 8;
  in_batches(rows_.size(), kBatch, progress, [&](std::size_t begin, std::size_t end) {
    parallel_for(end - begin, view.settings().threads,
                 [&](std::size_t k) { rows_[begin + k] = planes_of_row(view, sphere, begin + k); });
  });
}

Quad CornerPlanes::quad(std::size_t row, std::size_t column) const {
  const std::size_t right = (column + 1) % rows_[row].size();
  return {{rows_[row][column], rows_[row][right], rows_[row + 1][column], rows_[row + 1][right]},
          row,
          column};
}

double CornerPlanes::square_metres(const Sphere& sphere) const {
  double sum = 0;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const auto at = static_cast<double>(row);
    const double steradians =
        std::cos(sphere.elevation(at)) * sphere.row_angle * sphere.column_angle;
    for (std::size_t column = 0; column < sphere.columns; ++column) {
      const Plane& plane = rows_[row][column];
      if (plane.exists()) {
        sum += steradians * plane.area(sphere.direction(at, static_cast<double>(column)));
      }
    }
  }
  return sum;
}

}  // namespace curlidar
