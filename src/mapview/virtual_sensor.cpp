// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "curlidar/map_view.hpp"

namespace curlidar {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Status check_pose(const RigidMotion& pose) {
  bool good = std::isfinite(norm(pose.move));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const double off = dot(pose.rotation[i], pose.rotation[j]) - (i == j ? 1 : 0);
      good = good && std::abs(off) < 1e-3;
    }
  }
  if (good) return {};
  return Error{ErrorCode::invalid_argument,
               "the pose of the virtual sensor is no rotation and finite move"};
}

/// The beam of a ring at a column, in the sensor's frame.
MapRay beam_of(const SensorProfile& sensor, std::size_t ring_index, std::uint32_t column,
               bool beam_origins) {
  const Ring& ring = sensor.rings[ring_index];
  const double encoder =
      -std::numbers::pi + 2 * std::numbers::pi * column / static_cast<double>(sensor.columns);
  const double azimuth = encoder + ring.azimuth_offset;
  MapRay beam{{}, direction_of(ring.elevation, azimuth)};
  if (!beam_origins) return beam;
  const double out = sensor.beam_origin_radius_m, left = ring.horizontal_offset_m;
  beam.origin = {out * std::cos(encoder) - left * std::sin(azimuth),
                 out * std::sin(encoder) + left * std::cos(azimuth), ring.vertical_offset_m};
  return beam;
}

/// Points, normals and intensities of all slots; NaN where nothing is.
struct Finds {
  std::vector<Vec3> points, normals;
  std::vector<float> intensity;

  Finds(std::size_t slots, bool with_normals)
      : points(slots, {kNaN, kNaN, kNaN}),
        normals(with_normals ? slots : 0, {kNaN, kNaN, kNaN}),
        intensity(slots, std::numeric_limits<float>::quiet_NaN()) {}

  void put(std::size_t slot, const MapRay& beam, const MapHit& hit, const RigidMotion& pose) {
    points[slot] = beam.origin + beam.direction * hit.range_m;
    intensity[slot] = hit.intensity;
    if (!normals.empty()) normals[slot] = pose.turned_back(hit.normal);
  }
};

MapRay in_map(const RigidMotion& pose, const MapRay& beam) {
  return {pose(beam.origin), pose.turned(beam.direction)};
}

void look_around(const MapScene& scene, const SensorProfile& sensor, const RigidMotion& pose,
                 const SampleMapSettings& settings, std::size_t ring, Finds& finds) {
  // Sensors count ranges from where the beam would start without the radius of its origin.
  const double lead = settings.beam_origins ? sensor.beam_origin_radius_m : 0;
  for (std::uint32_t column = 0; column < sensor.columns; ++column) {
    const MapRay beam = beam_of(sensor, ring, column, settings.beam_origins);
    const MapHit hit = scene.cast(in_map(pose, beam), sensor.max_range_m - lead);
    if (!hit.found() || hit.range_m + lead < sensor.min_range_m) continue;
    finds.put(ring * sensor.columns + column, beam, hit, pose);
  }
}

Attribute component(const char* name, const std::vector<Vec3>& vectors, double Vec3::*axis) {
  std::vector<float> values;
  values.reserve(vectors.size());
  for (const Vec3& v : vectors) values.push_back(static_cast<float>(v.*axis));
  return {name, 1, std::move(values)};
}

Cloud cloud_of(Finds finds, const MapScene& scene) {
  Cloud cloud;
  cloud.positions = std::move(finds.points);
  cloud.width = static_cast<std::uint32_t>(cloud.positions.size());
  if (scene.has_intensity()) {
    cloud.attributes.push_back({"intensity", 1, std::move(finds.intensity)});
  }
  if (!finds.normals.empty()) {
    cloud.attributes.push_back(component("normal_x", finds.normals, &Vec3::x));
    cloud.attributes.push_back(component("normal_y", finds.normals, &Vec3::y));
    cloud.attributes.push_back(component("normal_z", finds.normals, &Vec3::z));
  }
  return cloud;
}

}  // namespace

Result<Cloud> sample_map(const MapScene& scene, const SensorProfile& sensor,
                         const RigidMotion& T_map_sensor, const SampleMapSettings& settings) {
  CURLIDAR_TRY(validate(sensor));
  CURLIDAR_TRY(check_pose(T_map_sensor));
  if (sensor.pattern != ScanPattern::spinning) {
    return Error{ErrorCode::unsupported,
                 fmt::format("the sensor {} does not turn around: only spinning ones are imitated",
                             sensor.name)};
  }
  const std::size_t rings = sensor.rings.size(), slots = rings * sensor.columns;
  Finds finds(slots, settings.normals);
  parallel_for(rings, settings.threads, [&](std::size_t ring) {
    look_around(scene, sensor, T_map_sensor, settings, ring, finds);
  });
  Cloud cloud = cloud_of(std::move(finds), scene);
  cloud.width = sensor.columns;
  cloud.height = static_cast<std::uint32_t>(rings);
  std::vector<std::uint16_t> ring_of(slots);
  for (std::size_t i = 0; i < slots; ++i) {
    ring_of[i] = static_cast<std::uint16_t>(i / sensor.columns);
  }
  cloud.attributes.push_back({"ring", 1, std::move(ring_of)});
  cloud.metadata["source"] = fmt::format("a map as sensor {} sees it", sensor.name);
  return cloud;
}

Result<Cloud> sample_map_along(const MapScene& scene, const Cloud& scan,
                               const RigidMotion& T_map_sensor, double max_range_m,
                               const SampleMapSettings& settings) {
  constexpr std::size_t kLinesPerTask = 1024;
  CURLIDAR_TRY(check_pose(T_map_sensor));
  Finds finds(scan.size(), settings.normals);
  const std::size_t tasks = (scan.size() + kLinesPerTask - 1) / kLinesPerTask;
  parallel_for(tasks, settings.threads, [&](std::size_t task) {
    const std::size_t end = std::min(scan.size(), (task + 1) * kLinesPerTask);
    for (std::size_t i = task * kLinesPerTask; i < end; ++i) {
      const Vec3& p = scan.positions[i];
      if (!is_return(p)) continue;
      const MapRay beam{{}, p * (1 / norm(p))};
      const MapHit hit = scene.cast(in_map(T_map_sensor, beam), max_range_m);
      if (hit.found()) finds.put(i, beam, hit, T_map_sensor);
    }
  });
  Cloud cloud = cloud_of(std::move(finds), scene);
  cloud.width = scan.width, cloud.height = scan.height;
  cloud.metadata["source"] = "a map along the lines of sight of a scan";
  return cloud;
}

}  // namespace curlidar
