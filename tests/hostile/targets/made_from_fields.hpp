// SPDX-License-Identifier: BSD-3-Clause
// All that is made from the field of a decoded file, on a small scale, whatever the file says.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "curlidar/reconstruct.hpp"

namespace curlidar::test {

inline bool is_point_or_nothing(const Vec3& p) {
  const bool nothing = std::isnan(p.x) && std::isnan(p.y) && std::isnan(p.z);
  return nothing || (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
}

/// What is wrong with a cloud or its refusal; empty: nothing.
inline std::string check_made(const Result<Cloud>& cloud, const ReconstructSettings& settings) {
  if (!cloud) return cloud.error().message.empty() ? "an error without a message" : "";
  if (cloud->size() > settings.max_points) return "more points than allowed";
  for (const Vec3& p : cloud->positions) {
    if (!is_point_or_nothing(p)) return "neither a point nor nothing";
  }
  for (const Attribute& attribute : cloud->attributes) {
    if (size_of(attribute.values) != cloud->size() * attribute.components) {
      return "an attribute of another length: " + attribute.name;
    }
  }
  const Attribute* confidence = cloud->find("confidence");
  for (std::size_t i = 0; confidence != nullptr && i < cloud->size(); ++i) {
    const double sure = confidence->as_double(i);
    if (!(sure >= 0 && sure <= 1)) return "a confidence that is no probability";
  }
  return "";
}

inline std::string check_mesh_of(const DecodedScan& scan, const ReconstructSettings& settings) {
  const auto mesh = reconstruct_mesh(scan, settings);
  if (!mesh) return mesh.error().message.empty() ? "an error without a message" : "";
  for (const Vec3& p : mesh->vertices) {
    if (!is_return(p)) return "a vertex that is no point";
  }
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh->vertices.size()) return "a triangle without its vertex";
    }
  }
  if (settings.normals && mesh->normals.size() != mesh->vertices.size()) return "normals missing";
  return "";
}

/// A sensor that looks wherever files do.
inline SensorProfile all_round_sensor() {
  SensorProfile sensor;
  sensor.name = "all round";
  sensor.columns = 32;
  sensor.fov_up = 1.5;
  sensor.fov_down = -1.5;
  sensor.max_range_m = 1e6;
  for (int i = 0; i < 7; ++i) {
    sensor.rings.push_back({.elevation = 1.5 - 0.5 * i, .vertical_offset_m = 0.1 * i});
  }
  return sensor;
}

/// Directions of all lengths, along the axes and in between, and towards the first returns.
inline std::vector<Vec3> all_directions(const DecodedScan& scan) {
  std::vector<Vec3> directions;
  for (const double length : {1e-300, 1.0, 1e150}) {
    for (const Vec3& axis : {Vec3{1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {-1, 0, 0}}) {
      directions.push_back(axis * length);
    }
  }
  for (int i = 0; i < 64; ++i) {
    directions.push_back({std::cos(0.7 * i), std::sin(0.7 * i), 0.03 * (i % 21) - 0.3});
  }
  for (std::size_t i = 0; i < scan.points.size() && i < 16; ++i) {
    const double length = norm(scan.points[i]);
    if (std::isfinite(length) && length > 0) directions.push_back(scan.points[i]);
  }
  return directions;
}

/// A thin part of the scan around its first return, so that densities ask little.
inline ScanRegion thin_part(const DecodedScan& scan) {
  const double middle = scan.points.empty() ? 0 : azimuth_of(scan.points.front());
  ScanRegion part;
  part.azimuth_begin = middle - 0.02;
  part.azimuth_end = middle + 0.02;
  return part;
}

/// What is wrong with anything made of the scan with a strategy.
inline std::string check_everything_made(const DecodedScan& scan, DenseStrategy strategy) {
  ReconstructSettings settings;
  settings.strategy = strategy;
  settings.max_points = 1u << 14;
  settings.normals = settings.original = true;
  settings.confidence = strategy == DenseStrategy::best;
  settings.min_confidence = settings.confidence ? 0.01 : 0;
  const SensorProfile sensor = all_round_sensor();
  for (const bool masks : {true, false}) {
    settings.masks = masks;
    for (const std::string& wrong :
         {check_made(reconstruct_directions(scan, all_directions(scan), settings), settings),
          check_made(reconstruct_sensor(scan, sensor, settings), settings)}) {
      if (!wrong.empty()) return wrong;
    }
  }
  settings.rows = 0.6;
  settings.columns = 1.3;
  if (std::string wrong = check_mesh_of(scan, settings); !wrong.empty()) return wrong;
  settings.rows = settings.columns = 1;
  settings.region = thin_part(scan);
  settings.keep_originals = true;
  const double density = strategy == DenseStrategy::best ? 1 : kMostDensity;
  return check_made(reconstruct_density(scan, density, settings), settings);
}

}  // namespace curlidar::test
