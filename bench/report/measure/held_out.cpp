// SPDX-License-Identifier: BSD-3-Clause
// Reconstruction between the rings of a real scan: rings 0, K, 2K .. are coded, the returns of the
// rings between them are predicted in their exact directions.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/try.hpp"
#include "report/measure/held_out.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/methods.hpp"
#include "report/measure/truth.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

/// Why rings cannot be held out; empty if they can.
std::string why_not(const Detection& detection, std::uint32_t every) {
  if (detection.sensor.pattern == ScanPattern::limited_field) {
    return "the scan comes from a limited-field scanner";
  }
  if (detection.source == RingSource::uniform) return "the rings of the scan cannot be told";
  if (detection.sensor.rings.size() <= 2 * std::size_t{every}) {
    return fmt::format("{} rings are too few", detection.sensor.rings.size());
  }
  return {};
}

/// The paper's settings for fewer rows. No more columns than the sensor has, or directions between
/// them would see empty cells for cliffs. Rows spread evenly over the field of view are not where
/// the rings of every sensor are, and fewer of them miss by more: rows are the rings. What is
/// farther from the next row than a cliff allows must be allowed to be so by as much more.
EncodeSettings for_every_nth(EncodeSettings settings, const SensorProfile& sensor,
                             std::uint32_t every) {
  settings.sensor = sensor;
  settings.paper.row_rule = RowRule::rings;
  settings.paper.columns = std::min(settings.paper.columns, sensor.columns);
  CliffThresholds& cliffs = settings.paper.cliffs;
  cliffs.row_m *= every;
  cliffs.diagonal_m = std::hypot(cliffs.row_m, cliffs.column_m);
  return settings;
}

/// Ranges that a method tells in the directions of the points; nothing without a sampler.
std::vector<double> predict(const Method& method, const std::vector<Vec3>& points) {
  std::vector<double> ranges;
  if (!method.sampler) return ranges;
  for (const Vec3& p : points) ranges.push_back(method.sampler->range(p * (1 / norm(p))));
  return ranges;
}

/// Which of the points every method tells a range of within the limits.
std::vector<bool> told_by_all(const std::vector<std::vector<double>>& predictions,
                              std::size_t points, const RangeLimits& limits) {
  std::vector<bool> told(points, true);
  for (const std::vector<double>& ranges : predictions) {
    for (std::size_t i = 0; i < ranges.size(); ++i) told[i] = told[i] && limits.hold(ranges[i]);
  }
  return told;
}

void print_errors(const Method& method, const std::vector<double>& ranges,
                  const std::vector<Vec3>& held_out, const std::vector<bool>& common,
                  const RangeLimits& limits) {
  Json line = method.header();
  if (method.sampler) {
    RayTally all(limits), shared(limits);
    for (std::size_t i = 0; i < held_out.size(); ++i) {
      all.add(ranges[i], norm(held_out[i]));
      if (common[i]) shared.add(ranges[i], norm(held_out[i]));
    }
    line.update(to_json(all.errors()));
    line.erase("no_surface");  // returns only tell where there is one
    line["common"] = to_json(shared.errors().stats);
  }
  print_line(line);
}

}  // namespace

RingSplit split_rings(const Cloud& cloud, const Detection& detection, std::uint32_t every) {
  RingSplit split;
  const std::size_t rings = detection.sensor.rings.size();
  const std::size_t last = (rings - 1) / every * every;
  split.sensor = detection.sensor;
  split.sensor.name = fmt::format("{}-every-{}", detection.sensor.name, every);
  split.sensor.rings.clear();
  for (std::size_t ring = 0; ring <= last; ring += every) {
    split.sensor.rings.push_back(detection.sensor.rings[ring]);
    split.elevations.push_back(detection.ring_elevations[ring]);
  }
  std::vector<std::uint32_t> coded;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const std::uint16_t ring = detection.ring_of_point[i];
    if (!is_return(cloud.positions[i]) || ring > last) continue;
    if (ring % every == 0) {
      coded.push_back(i);
      split.ring_of_point.push_back(static_cast<std::uint16_t>(ring / every));
    } else {
      split.held_out.push_back(cloud.positions[i]);
    }
  }
  split.coded = select(cloud, coded);
  split.coded.attributes.clear();
  return split;
}

Status held_out(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(every, arguments.number("every", 2, 2, 64));
  CURLIDAR_TRY_ASSIGN(scan, read_scan(arguments));
  CURLIDAR_TRY_ASSIGN(detection, scan.settings.sensor
                                     ? assign_rings(scan.cloud, *scan.settings.sensor)
                                     : detect_sensor(scan.cloud));
  if (const std::string reason = why_not(detection, every); !reason.empty()) {
    print_line({{"skipped", reason}});
    return {};
  }
  const RingSplit split = split_rings(scan.cloud, detection, every);
  const EncodeSettings paper = for_every_nth(scan.settings, split.sensor, every);
  CURLIDAR_TRY_ASSIGN(limits, limits_of(split.coded, paper));
  print_line({{"preset", scan.preset},
              {"sensor", detection.sensor.name},
              {"rings_from", to_string(detection.source)},
              {"rings", detection.sensor.rings.size()},
              {"rings_coded", split.sensor.rings.size()},
              {"returns_coded", split.coded.size()},
              {"returns_held_out", split.held_out.size()},
              {"min_range_m", limits.min_m},
              {"max_range_m", limits.max_m}});
  const std::vector<Method> methods =
      make_methods({.cloud = &split.coded,
                    .paper = paper,
                    .compact_sensor = split.sensor,  // or it might find the whole sensor again
                    .ring_of_point = split.ring_of_point,
                    .ring_elevations = split.elevations,
                    .columns = split.sensor.columns});
  std::vector<std::vector<double>> predictions;
  for (const Method& method : methods) predictions.push_back(predict(method, split.held_out));
  const std::vector<bool> common = told_by_all(predictions, split.held_out.size(), limits);
  for (std::size_t i = 0; i < methods.size(); ++i) {
    print_errors(methods[i], predictions[i], split.held_out, common, limits);
  }
  return {};
}

}  // namespace curlidar::bench
