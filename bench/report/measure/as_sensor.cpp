// SPDX-License-Identifier: BSD-3-Clause
// A simulated scan, coded, as another sensor sees it, against what that sensor's beams meet.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/try.hpp"
#include "curlidar/reconstruct.hpp"
#include "report/measure/codecs.hpp"
#include "report/measure/judge.hpp"
#include "report/measure/truth.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

/// The beams of a sensor, ring by ring, where they leave it (docs/sensors.md).
std::vector<Sightline> beams_of(const SensorProfile& sensor) {
  std::vector<Sightline> lines;
  for (const Ring& ring : sensor.rings) {
    for (std::uint32_t column = 0; column < sensor.columns; ++column) {
      const double encoder = -std::numbers::pi + 2 * std::numbers::pi * column / sensor.columns;
      const double azimuth = encoder + ring.azimuth_offset;
      const double out = sensor.beam_origin_radius_m, left = ring.horizontal_offset_m;
      lines.push_back({{out * std::cos(encoder) - left * std::sin(azimuth),
                        out * std::sin(encoder) + left * std::cos(azimuth), ring.vertical_offset_m},
                       direction_of(ring.elevation, azimuth)});
    }
  }
  return lines;
}

/// What the beams meet within the sensor's range; NaN for nothing.
std::vector<double> met_by(const std::vector<Sightline>& beams, const SensorProfile& sensor,
                           const Scene& scene) {
  std::vector<double> ranges;
  for (const Sightline& beam : beams) {
    Hit hit;
    const bool met = scene.cast(beam.origin, beam.direction, hit);
    const double counted = hit.range_m + sensor.beam_origin_radius_m;
    const bool within = met && counted >= sensor.min_range_m && counted <= sensor.max_range_m;
    ranges.push_back(within ? hit.range_m : std::numeric_limits<double>::quiet_NaN());
  }
  return ranges;
}

/// The points of an organised cloud as ranges along the beams; an error if they lie beside them.
Result<std::vector<RangeEstimate>> told_along(const std::vector<Sightline>& beams,
                                              const Cloud& cloud) {
  constexpr double kBeside_m = 1e-6;
  if (cloud.size() != beams.size()) {
    return Error{ErrorCode::invalid_argument, "the cloud has not a point for every beam"};
  }
  std::vector<RangeEstimate> told(beams.size());
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (!is_return(cloud.positions[i])) continue;
    const double range_m = norm(cloud.positions[i] - beams[i].origin);
    const Vec3 there = beams[i].origin + beams[i].direction * range_m;
    if (norm(cloud.positions[i] - there) > kBeside_m * std::max(range_m, 1.0)) {
      return Error{ErrorCode::invalid_argument, fmt::format("point {} is not on its beam", i)};
    }
    told[i] = {range_m, 1, Seen::surface};
  }
  return told;
}

/// The beams between the outermost rings that were coded, the others without truth and answer.
std::vector<double> within_band(std::vector<double> true_m, const std::vector<Sightline>& beams,
                                std::vector<RangeEstimate>& told, const SensorProfile& coded) {
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const double up = elevation_of(beams[i].direction);
    if (up <= coded.rings.front().elevation && up >= coded.rings.back().elevation) continue;
    true_m[i] = std::numeric_limits<double>::quiet_NaN();
    told[i] = {};
  }
  return true_m;
}

}  // namespace

Status as_sensor(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(seed, arguments.number("seed", 1, 0, 1u << 30));
  CURLIDAR_TRY_ASSIGN(
      simulated, simulate_scan(arguments.words[0], arguments.words[1], arguments.words[2], seed));
  CURLIDAR_TRY_ASSIGN(sensor, builtin_sensor(arguments.words[3]));
  const std::vector<Sightline> beams = beams_of(sensor);
  const std::vector<double> truth = met_by(beams, sensor, *simulated.scene);
  const std::array targets{std::tuple{"5 mm", CompactTarget::error, 0.005},
                           std::tuple{"1 bit a return", CompactTarget::bits_per_point, 1.0}};
  for (const auto& [setting, target, value] : targets) {
    CURLIDAR_TRY_ASSIGN(encoded, encode(simulated.cloud, compact_of_scan(target, value)));
    CURLIDAR_TRY_ASSIGN(decoded, decode(encoded.bytes));
    ReconstructSettings settings;
    settings.organised = true;
    CURLIDAR_TRY_ASSIGN(cloud, reconstruct_sensor(decoded, sensor, settings));
    CURLIDAR_TRY_ASSIGN(told, told_along(beams, cloud));
    const RayErrors all = Judge(truth, {}).errors(told);
    const std::vector<double> in_band = within_band(truth, beams, told, *simulated.settings.sensor);
    Json line{{"setting", setting}, {"bits_per_point", encoded.report.bits_per_point}};
    line.update(to_json(Judge(in_band, {}).errors(told)));
    line["all_completeness"] = all.completeness;
    line["all_points"] = all.points;
    print_line(line);
  }
  return {};
}

}  // namespace curlidar::bench
