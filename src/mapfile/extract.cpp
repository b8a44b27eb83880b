// SPDX-License-Identifier: BSD-3-Clause
// Points on the surface of a map file.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/try.hpp"
#include "curlidar/map.hpp"
#include "map/tile_points.hpp"

namespace curlidar {
namespace {

Vec3 unit(std::size_t axis) {
  return {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
}

/// Of a leaf's surface at a point, along its axis or upwards.
Vec3 leaf_normal(const MapLeaf& leaf, const Vec3& p) {
  const Vec3 u = unit((leaf.axis + 1u) % 3), v = unit((leaf.axis + 2u) % 3);
  const double du = dot(p - leaf.centre, u), dv = dot(p - leaf.centre, v);
  const double su = leaf.slope[0] + 2 * leaf.curve[0] * du + leaf.curve[1] * dv;
  const double sv = leaf.slope[1] + leaf.curve[1] * du + 2 * leaf.curve[2] * dv;
  const Vec3 normal = unit(leaf.axis) - u * su - v * sv;
  return normal * ((leaf.axis != 2 && normal.z < 0 ? -1 : 1) / norm(normal));
}

/// The cloud that points are put into.
class PointSink {
 public:
  explicit PointSink(const MapExtractSettings& settings) : settings_(settings) {}

  Status add_tile(const MapTile& tile, double spacing_m) {
    for (const MapLeaf& leaf : tile.leaves) {
      points_.clear();
      leaf_points(tile, leaf, spacing_m, points_);
      for (const MapSample& point : points_) {
        const Vec3 p = tile.origin + point.position;
        if (!inside(p)) continue;
        cloud_.positions.push_back(p);
        intensity_.push_back(leaf.intensity);
        if (settings_.normals) {
          const Vec3 normal = leaf_normal(leaf, point.position);
          normal_[0].push_back(static_cast<float>(normal.x));
          normal_[1].push_back(static_cast<float>(normal.y));
          normal_[2].push_back(static_cast<float>(normal.z));
        }
      }
      if (cloud_.size() > settings_.max_points) {
        return Error{ErrorCode::limit_exceeded,
                     fmt::format("more than {} points: ask for a part of the map, a wider spacing, "
                                 "or allow more",
                                 settings_.max_points)};
      }
    }
    return {};
  }

  Cloud finish(bool intensity) && {
    cloud_.position_type = ScalarType::float64;
    cloud_.width = static_cast<std::uint32_t>(cloud_.size());
    if (intensity) cloud_.attributes.push_back({"intensity", 1, std::move(intensity_)});
    if (settings_.normals) {
      const char* names[] = {"normal_x", "normal_y", "normal_z"};
      for (std::size_t k = 0; k < 3; ++k) {
        cloud_.attributes.push_back({names[k], 1, std::move(normal_[k])});
      }
    }
    return std::move(cloud_);
  }

 private:
  bool inside(const Vec3& p) const {
    if (settings_.box) {
      const auto& [low, high] = *settings_.box;
      if (!(p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z &&
            p.z <= high.z)) {
        return false;
      }
    }
    return !settings_.centre || norm(p - *settings_.centre) <= settings_.radius_m;
  }

  const MapExtractSettings& settings_;
  Cloud cloud_;
  std::vector<float> intensity_;
  std::array<std::vector<float>, 3> normal_;
  std::vector<MapSample> points_;
};

/// What the settings leave of the map, as a box.
MapBox asked_box(const MapExtractSettings& settings) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  MapBox box{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  if (settings.box) box = *settings.box;
  if (settings.centre) {
    const Vec3 reach{settings.radius_m, settings.radius_m, settings.radius_m};
    const Vec3 low = *settings.centre - reach, high = *settings.centre + reach;
    box.low = {std::max(box.low.x, low.x), std::max(box.low.y, low.y), std::max(box.low.z, low.z)};
    box.high = {std::min(box.high.x, high.x), std::min(box.high.y, high.y),
                std::min(box.high.z, high.z)};
  }
  return box;
}

}  // namespace

Result<Cloud> extract_points(const MapFile& map, const MapExtractSettings& settings,
                             const ProgressCallback& progress, std::vector<std::string>* damaged) {
  if (!(settings.spacing_m >= 1e-3 && settings.spacing_m <= 1e3)) {
    return Error{
        ErrorCode::invalid_argument,
        fmt::format("a spacing of {:g} m; it must be from 0.001 to 1000 m", settings.spacing_m)};
  }
  if (map.header().kind != MapKind::surface) {
    return Error{ErrorCode::invalid_argument, "a map of scans has no surface to take points from"};
  }
  const std::vector<std::size_t> needed = map.parts_in(asked_box(settings));
  PointSink sink(settings);
  std::size_t done = 0;
  for (const std::size_t i : needed) {
    if (progress)
      progress("extract", static_cast<double>(done++) / static_cast<double>(needed.size()));
    if (settings.tile && map.tiles()[i].key != *settings.tile) continue;
    const auto tile = map.read_tile(i, settings.max_level);
    if (!tile && (damaged == nullptr || tile.error().code == ErrorCode::io)) return tile.error();
    if (!tile) {
      damaged->push_back(tile.error().message);
      continue;
    }
    CURLIDAR_TRY(sink.add_tile(*tile, settings.spacing_m));
  }
  return std::move(sink).finish(map.header().surface.intensity);
}

}  // namespace curlidar
