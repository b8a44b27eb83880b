// SPDX-License-Identifier: BSD-3-Clause
// Between points and the rays of a beam model.
#include <cmath>
#include <numbers>

#include "sensor/lattice.hpp"

namespace curlidar {

std::optional<BeamModel> beam_model_of(const SensorProfile& profile) {
  if (profile.slots == 0) return std::nullopt;
  BeamModel model;
  model.slots = profile.slots;
  model.range_unit_m = profile.range_unit_m;
  const double radius = profile.beam_origin_radius_m;
  for (const Ring& ring : profile.rings) {
    Beam beam{ring.elevation, ring.azimuth_offset, ring.vertical_offset_m, ring.horizontal_offset_m,
              ring.range_phase_m};
    // A beam that starts `radius` from the axis at the encoder's angle, and looks azimuth_offset
    // away from it: the start is taken back along the beam to beside the axis. What is measured is
    // the range from the axis, radius more than from the start.
    const double ahead = radius * std::cos(beam.azimuth_offset);
    beam.lateral_m -= radius * std::sin(beam.azimuth_offset);
    beam.height_m -= ahead * std::tan(beam.elevation);
    beam.range_phase_m += ahead / std::cos(beam.elevation) - radius;
    model.beams.push_back(beam);
  }
  return model;
}

std::span<const BeamModel> builtin_beam_models() {
  static const std::vector<BeamModel> models = [] {
    std::vector<BeamModel> out;
    for (const std::string& name : builtin_sensor_names()) {
      const auto profile = builtin_sensor(name);
      if (!profile) continue;
      if (auto model = beam_model_of(*profile)) out.push_back(std::move(*model));
    }
    return out;
  }();
  return models;
}

Vec3 lattice_point(const BeamModel& model, std::size_t ring, std::uint32_t position, double range) {
  const Beam& beam = model.beams[ring];
  const double a =
      -std::numbers::pi + 2 * std::numbers::pi * position / model.slots + beam.azimuth_offset;
  const double along = range + beam.range_phase_m;
  const double u = along * std::cos(beam.elevation);
  return {u * std::cos(a) - beam.lateral_m * std::sin(a),
          u * std::sin(a) + beam.lateral_m * std::cos(a),
          along * std::sin(beam.elevation) + beam.height_m};
}

std::optional<BeamView> view_along(const Beam& beam, const Vec3& point) {
  const double square = point.x * point.x + point.y * point.y - beam.lateral_m * beam.lateral_m;
  if (!(square > 0)) return std::nullopt;
  const double u = std::sqrt(square), z = point.z - beam.height_m;
  const double c = std::cos(beam.elevation), s = std::sin(beam.elevation);
  BeamView view;
  view.range = u * c + z * s - beam.range_phase_m;
  view.up_m = z * c - u * s;
  view.encoder = std::remainder(
      std::atan2(point.y, point.x) - std::atan2(beam.lateral_m, u) - beam.azimuth_offset,
      2 * std::numbers::pi);
  view.distance_m = std::sqrt(square + beam.lateral_m * beam.lateral_m);
  return view;
}

}  // namespace curlidar
