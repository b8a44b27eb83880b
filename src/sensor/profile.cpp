// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "curlidar/sensor.hpp"
#include "sensor/angles.hpp"

namespace curlidar {
namespace {

bool finite_and_inside(double angle, double limit) {
  return std::isfinite(angle) && std::abs(angle) <= limit;
}

Status validate_ring(const SensorProfile& profile, std::size_t i) {
  const auto invalid = [&](const char* what) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("sensor \"{}\", ring {}: {}", profile.name, i, what)};
  };
  const Ring& ring = profile.rings[i];
  if (!finite_and_inside(ring.elevation, std::numbers::pi / 2)) {
    return invalid("the elevation must lie within +-90 degrees");
  }
  if (!finite_and_inside(ring.azimuth_offset, 2 * std::numbers::pi)) {
    return invalid("the azimuth offset must lie within +-360 degrees");
  }
  if (!finite_and_inside(ring.vertical_offset_m, 10) ||
      !finite_and_inside(ring.horizontal_offset_m, 10)) {
    return invalid("offsets of the beam's origin must lie within +-10 m");
  }
  if (!finite_and_inside(ring.range_phase_m, 10)) {
    return invalid("the range phase must lie within +-10 m");
  }
  if (i > 0 && !(ring.elevation < profile.rings[i - 1].elevation)) {
    return invalid("elevations must descend strictly from the top ring to the bottom one");
  }
  return {};
}

}  // namespace

std::vector<double> SensorProfile::elevations() const {
  std::vector<double> out;
  out.reserve(rings.size());
  for (const Ring& ring : rings) out.push_back(ring.elevation);
  return out;
}

double SensorProfile::apparent_elevation(std::size_t ring, double distance_m) const {
  const Ring& r = rings[ring];
  return std::atan2(
      r.vertical_offset_m + (distance_m - beam_origin_radius_m) * std::tan(r.elevation),
      distance_m);
}

Status validate(const SensorProfile& profile) {
  const auto invalid = [&](const std::string& what) {
    return Error{ErrorCode::invalid_argument, fmt::format("sensor \"{}\": {}", profile.name, what)};
  };
  if (profile.rings.empty() || profile.rings.size() > kMaxRings) {
    return invalid(
        fmt::format("{} rings, but a sensor has 1 to {}", profile.rings.size(), kMaxRings));
  }
  for (std::size_t i = 0; i < profile.rings.size(); ++i) {
    if (Status status = validate_ring(profile, i); !status) return status;
  }
  if (profile.columns < 4 || profile.columns > 65536) {
    return invalid(fmt::format("{} columns in a turn, allowed are 4 to 65536", profile.columns));
  }
  if (!finite_and_inside(profile.fov_up, std::numbers::pi / 2) ||
      !finite_and_inside(profile.fov_down, std::numbers::pi / 2)) {
    return invalid("the field of view must lie within +-90 degrees");
  }
  const bool flat = profile.rings.size() == 1 && profile.fov_up == profile.fov_down;
  if (!(profile.fov_up > profile.fov_down) && !flat) {
    return invalid(
        fmt::format("the upper edge of the field of view ({:.4g} degrees) must be "
                    "above the lower one ({:.4g} degrees)",
                    degrees_of(profile.fov_up), degrees_of(profile.fov_down)));
  }
  if (!std::isfinite(profile.max_range_m) || !(profile.min_range_m >= 0) ||
      !(profile.min_range_m < profile.max_range_m)) {
    return invalid(fmt::format("ranges must satisfy 0 <= minimum < maximum, not {} .. {} m",
                               profile.min_range_m, profile.max_range_m));
  }
  if (!finite_and_inside(profile.beam_origin_radius_m, 10)) {
    return invalid("the radius of the beam origins must lie within +-10 m");
  }
  if (profile.slots > kMaxSlots) {
    return invalid(fmt::format("at most {} encoder positions (slots) make a turn, not {}",
                               kMaxSlots, profile.slots));
  }
  if (!finite_and_inside(profile.range_unit_m, 10) || profile.range_unit_m < 0) {
    return invalid("the range unit must lie within 0 .. 10 m");
  }
  return {};
}

}  // namespace curlidar
