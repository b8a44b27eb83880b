// SPDX-License-Identifier: BSD-3-Clause
#include "protocol/tulip_image.hpp"

#include <cmath>

#include "sensor/angles.hpp"

namespace curlidar::bench::tulip {
namespace {

constexpr double kRowStep_deg = (kHighest_deg - kLowest_deg) / (kRows - 1);
constexpr double kColumnStep_deg = 360.0 / kColumns;

}  // namespace

double elevation_of_row(double row) {
  return radians_of(kLowest_deg + kRowStep_deg * row);
}

double azimuth_of_column(double column) {
  return radians_of((column + 1 - kColumns / 2.0) * kColumnStep_deg);
}

bool locate(const Vec3& point, std::size_t& row, std::size_t& column) {
  const double up = std::round((degrees_of(elevation_of(point)) - kLowest_deg) / kRowStep_deg);
  const double turned_deg = degrees_of(std::atan2(point.x, point.y)) - 90;
  double across = kColumns / 2.0 - std::trunc(turned_deg / kColumnStep_deg);
  if (across >= kColumns) across -= kColumns;
  if (!(up >= 0 && up < kRows && across >= 0 && across < kColumns)) return false;
  row = static_cast<std::size_t>(up);
  column = static_cast<std::size_t>(across);
  return true;
}

Image project(const Cloud& cloud) {
  Image image;
  for (const Vec3& p : cloud.positions) {
    std::size_t row = 0, column = 0;
    if (!is_return(p) || !locate(p, row, column)) continue;
    const double range = norm(p);
    image.at(row, column) = range <= kLongest_m ? range : 0;
  }
  for (double& range : image.range_m) range = range <= kMost_m ? range : 0;
  return image;
}

Image given_rows(const Image& image) {
  Image given;
  for (std::size_t row = 0; row < kRows; row += kEvery) {
    for (std::size_t column = 0; column < kColumns; ++column) {
      given.at(row, column) = image.at(row, column);
    }
  }
  return given;
}

Cloud points_of(const Image& image) {
  Cloud cloud;
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t column = 0; column < kColumns; ++column) {
      const double range = image.at(row, column);
      if (range <= 0) continue;
      const Vec3 direction = direction_of(elevation_of_row(static_cast<double>(row)),
                                          azimuth_of_column(static_cast<double>(column)));
      cloud.positions.push_back(direction * range);
    }
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  return cloud;
}

}  // namespace curlidar::bench::tulip
