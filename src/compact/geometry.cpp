// SPDX-License-Identifier: BSD-3-Clause
#include "compact/geometry.hpp"

#include <algorithm>
#include <utility>

namespace curlidar::compact {
namespace {

std::int32_t q22(std::int64_t a, std::int64_t b) {
  return static_cast<std::int32_t>(shift_right_round(a * b, 38));
}

Direction direction_at(const SinCos& elevation, const SinCos& azimuth) {
  return {q22(elevation.cos, azimuth.cos), q22(elevation.cos, azimuth.sin),
          static_cast<std::int32_t>(shift_right_round(elevation.sin, 8))};
}

Origin origin_of(const Ray& ray, const SinCos& azimuth, std::int32_t centre) {
  const auto across = [&](std::int64_t part) {
    return static_cast<std::int32_t>(shift_right_round(ray.lateral * part, 30));
  };
  return {-across(azimuth.sin), across(azimuth.cos), ray.height - centre};
}

bool has_origins(const RayTable& rays, std::int32_t centre) {
  return std::any_of(rays.rays.begin(), rays.rays.end(),
                     [&](const Ray& ray) { return ray.lateral != 0 || ray.height != centre; });
}

}  // namespace

std::int32_t centre_height(const RayTable& rays) {
  std::int64_t sum = 0;
  for (const Ray& ray : rays.rays) sum += ray.height;
  return static_cast<std::int32_t>(div_floor(sum, static_cast<std::int64_t>(rays.rays.size())));
}

Geometry::Geometry(std::vector<std::int32_t> elevations, std::uint32_t turn_columns,
                   std::uint32_t first_column, std::uint32_t columns)
    : elevations_(std::move(elevations)),
      turn_columns_(turn_columns),
      first_column_(first_column),
      columns_(columns) {
  std::vector<SinCos> azimuths(columns);
  for (std::uint32_t j = 0; j < columns; ++j) {
    azimuths[j] = sin_cos_q30(azimuth_of_column(first_column + j, turn_columns));
  }
  directions_.reserve(elevations_.size() * columns);
  for (const std::int32_t elevation : elevations_) {
    const SinCos up = sin_cos_q30(static_cast<std::uint32_t>(elevation));
    for (const SinCos& a : azimuths) directions_.push_back(direction_at(up, a));
  }
}

Geometry::Geometry(std::vector<std::int32_t> elevations, const RayTable& rays,
                   std::uint32_t first_row, std::uint32_t first_column, std::uint32_t columns)
    : elevations_(std::move(elevations)),
      turn_columns_(static_cast<std::uint32_t>(rays.firings.size())),
      first_column_(first_column),
      columns_(columns) {
  const std::int32_t centre = centre_height(rays);
  const bool origins = has_origins(rays, centre);
  directions_.reserve(elevations_.size() * columns);
  if (origins) origins_.reserve(directions_.capacity());
  for (std::size_t i = 0; i < elevations_.size(); ++i) {
    const std::size_t row = first_row + i;
    const SinCos up = sin_cos_q30(static_cast<std::uint32_t>(elevations_[i]));
    for (std::uint32_t j = 0; j < columns; ++j) {
      const SinCos azimuth = sin_cos_q30(rays.azimuth_of(row, first_column + j));
      directions_.push_back(direction_at(up, azimuth));
      if (origins) origins_.push_back(origin_of(rays.rays[row], azimuth, centre));
    }
  }
  for (const std::uint32_t firing : rays.firings) {
    column_azimuths_.push_back(rays.encoder_angle(firing));
  }
}

std::uint32_t Geometry::azimuth_of_sum(std::uint32_t sum_of_columns) const {
  const std::uint64_t sum = std::uint64_t{2} * first_column_ + sum_of_columns;
  if (!column_azimuths_.empty()) {
    const auto lower = static_cast<std::size_t>(sum / 2),
               upper = static_cast<std::size_t>((sum + 1) / 2);
    const std::uint32_t a = column_azimuths_[lower], b = column_azimuths_[upper];
    return a + (b - a) / 2;
  }
  return static_cast<std::uint32_t>(0x80000000u + ((sum << 31) / turn_columns_));
}

}  // namespace curlidar::compact
