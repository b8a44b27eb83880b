// SPDX-License-Identifier: BSD-3-Clause
// Points along lines of sight that somebody else chose: directions, or the beams of a sensor.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/try.hpp"
#include "reconstruct/finish.hpp"

namespace curlidar {
namespace {

Status check_directions(std::span<const Vec3> directions) {
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double length = norm(directions[i]);
    if (std::isfinite(length) && length > 0) continue;
    return Error{ErrorCode::invalid_argument,
                 fmt::format("direction {} (counted from 0) is ({}, {}, {}): give finite numbers, "
                             "not all of them 0",
                             i, directions[i].x, directions[i].y, directions[i].z)};
  }
  return {};
}

Status check_alone(const ReconstructSettings& settings, const char* what) {
  if (!settings.keep_originals) return {};
  return Error{ErrorCode::invalid_argument,
               fmt::format("the original returns have no place among {}", what)};
}

/// The beam of a ring at a column, as the sensor's own frame has it.
Sightline beam(const SensorProfile& sensor, std::size_t ring_index, std::uint32_t column) {
  const Ring& ring = sensor.rings[ring_index];
  const double encoder =
      -std::numbers::pi + 2 * std::numbers::pi * column / static_cast<double>(sensor.columns);
  const double azimuth = encoder + ring.azimuth_offset;
  const double out = sensor.beam_origin_radius_m, left = ring.horizontal_offset_m;
  return {{out * std::cos(encoder) - left * std::sin(azimuth),
           out * std::sin(encoder) + left * std::cos(azimuth), ring.vertical_offset_m},
          direction_of(ring.elevation, azimuth)};
}

/// Sensors count ranges from where the beam would start without the radius of its origin.
bool in_range(const SensorProfile& sensor, const Sightline& line, const Vec3& point) {
  const double range = norm(point - line.origin) + sensor.beam_origin_radius_m;
  return range >= sensor.min_range_m && range <= sensor.max_range_m;
}

/// What one ring of a virtual sensor sees.
Samples look_around(const ScanView& view, const SensorProfile& sensor, std::size_t ring) {
  std::vector<Sightline> lines;
  for (std::uint32_t column = 0; column < sensor.columns; ++column) {
    lines.push_back(beam(sensor, ring, column));
  }
  Samples samples;
  samples.resize(lines.size());
  samples.ring.assign(lines.size(), static_cast<std::uint16_t>(ring));
  view.look(lines, samples.points, samples.confidence, view.settings().threads);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    // NaN is out of range, too.
    if (!in_range(sensor, lines[i], samples.points[i])) samples.points[i] = kNowherePoint;
  }
  return samples;
}

}  // namespace

Result<Cloud> reconstruct_directions(const DecodedScan& scan, std::span<const Vec3> directions,
                                     const ReconstructSettings& settings,
                                     const ProgressCallback& progress) {
  constexpr std::size_t kBatch = 1u << 18;
  CURLIDAR_TRY(check_alone(settings, "given directions"));
  CURLIDAR_TRY(check_directions(directions));
  CURLIDAR_TRY(check_points(1, directions.size(), "directions", settings));
  CURLIDAR_TRY_ASSIGN(view, ScanView::make(scan, settings));
  Samples samples;
  samples.resize(directions.size());
  samples.width = static_cast<std::uint32_t>(directions.size());
  in_batches(directions.size(), kBatch, progress, [&](std::size_t begin, std::size_t end) {
    std::vector<Sightline> lines(end - begin);
    for (std::size_t i = begin; i < end; ++i) lines[i - begin].direction = directions[i];
    view.look(lines, std::span(samples.points).subspan(begin, lines.size()),
              std::span(samples.confidence).subspan(begin, lines.size()), settings.threads);
  });
  return finish(view, std::move(samples));
}

Result<Cloud> reconstruct_sensor(const DecodedScan& scan, const SensorProfile& sensor,
                                 const ReconstructSettings& settings,
                                 const ProgressCallback& progress) {
  CURLIDAR_TRY(check_alone(settings, "those of another sensor"));
  CURLIDAR_TRY(validate(sensor));
  if (sensor.pattern != ScanPattern::spinning) {
    return Error{ErrorCode::unsupported,
                 fmt::format("the sensor {} does not turn around: only spinning ones are imitated",
                             sensor.name)};
  }
  CURLIDAR_TRY(check_points(sensor.rings.size(), sensor.columns, "a sensor", settings));
  CURLIDAR_TRY_ASSIGN(view, ScanView::make(scan, settings, true));
  Samples samples;
  in_batches(sensor.rings.size(), 1, progress, [&](std::size_t ring, std::size_t) {
    samples.append(look_around(view, sensor, ring));
  });
  samples.width = sensor.columns;
  samples.height = static_cast<std::uint32_t>(sensor.rings.size());
  if (!settings.organised) samples.drop_empty();
  return finish(view, std::move(samples));
}

}  // namespace curlidar
