// SPDX-License-Identifier: BSD-3-Clause
// Reconstruction between the rings of a real scan: rings 0, K, 2K .. are coded, the returns of the
// rings between them are predicted in their exact directions.
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

void predict(const Method& method, const std::vector<Vec3>& held_out, const RangeLimits& limits) {
  Json line = method.header();
  if (method.sampler) {
    RayTally tally(limits);
    for (const Vec3& p : held_out) {
      const double range = norm(p);
      tally.add(method.sampler->range(p * (1 / range)), range);
    }
    line.update(tally.to_json());
    line.erase("no_surface");  // returns only tell where there is one
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
  EncodeSettings paper = scan.settings;
  paper.sensor = split.sensor;
  // Rows spread evenly over the field of view are not where the rings of every sensor are, and
  // fewer of them miss by more.
  paper.paper.row_rule = RowRule::rings;
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
  const std::vector<Method> methods = make_methods(
      {&split.coded, paper, split.sensor, split.ring_of_point, split.elevations});
  for (const Method& method : methods) predict(method, split.held_out, limits);
  return {};
}

}  // namespace curlidar::bench
