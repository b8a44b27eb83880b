// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

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

struct Scan {
  std::vector<Vec3> points, normals;
  std::vector<float> intensity;
};

void look_around(const MapScene& scene, const SensorProfile& sensor, const RigidMotion& pose,
                 const SampleMapSettings& settings, std::size_t ring, Scan& scan) {
  // Sensors count ranges from where the beam would start without the radius of its origin.
  const double lead = settings.beam_origins ? sensor.beam_origin_radius_m : 0;
  for (std::uint32_t column = 0; column < sensor.columns; ++column) {
    const MapRay beam = beam_of(sensor, ring, column, settings.beam_origins);
    const MapHit hit =
        scene.cast({pose(beam.origin), pose.turned(beam.direction)}, sensor.max_range_m - lead);
    if (!hit.found() || hit.range_m + lead < sensor.min_range_m) continue;
    const std::size_t slot = ring * sensor.columns + column;
    scan.points[slot] = beam.origin + beam.direction * hit.range_m;
    scan.intensity[slot] = hit.intensity;
    if (settings.normals) scan.normals[slot] = pose.turned_back(hit.normal);
  }
}

Attribute component(const char* name, const std::vector<Vec3>& vectors, double Vec3::*axis) {
  std::vector<float> values;
  values.reserve(vectors.size());
  for (const Vec3& v : vectors) values.push_back(static_cast<float>(v.*axis));
  return {name, 1, std::move(values)};
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
  Scan scan;
  scan.points.assign(slots, {kNaN, kNaN, kNaN});
  if (settings.normals) scan.normals.assign(slots, {kNaN, kNaN, kNaN});
  scan.intensity.assign(slots, std::numeric_limits<float>::quiet_NaN());
  parallel_for(rings, settings.threads, [&](std::size_t ring) {
    look_around(scene, sensor, T_map_sensor, settings, ring, scan);
  });
  Cloud cloud;
  cloud.positions = std::move(scan.points);
  cloud.width = sensor.columns;
  cloud.height = static_cast<std::uint32_t>(rings);
  if (scene.has_intensity()) {
    cloud.attributes.push_back({"intensity", 1, std::move(scan.intensity)});
  }
  std::vector<std::uint16_t> ring_of(slots);
  for (std::size_t i = 0; i < slots; ++i) {
    ring_of[i] = static_cast<std::uint16_t>(i / sensor.columns);
  }
  cloud.attributes.push_back({"ring", 1, std::move(ring_of)});
  if (settings.normals) {
    cloud.attributes.push_back(component("normal_x", scan.normals, &Vec3::x));
    cloud.attributes.push_back(component("normal_y", scan.normals, &Vec3::y));
    cloud.attributes.push_back(component("normal_z", scan.normals, &Vec3::z));
  }
  cloud.metadata["source"] = fmt::format("a map as sensor {} sees it", sensor.name);
  return cloud;
}

}  // namespace curlidar
