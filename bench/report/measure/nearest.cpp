// SPDX-License-Identifier: BSD-3-Clause
// Distances between a scan of which every K-th ring was kept and made denser again, and the whole
// scan: what the paper measures its upsampling by.
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/try.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/paper.hpp"
#include "protocol/ring_split.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/truth.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

Status print_distances(Json line, const Cloud& denser, const Cloud& whole) {
  CURLIDAR_TRY_ASSIGN(to_scan, nearest_distances(denser, whole));
  CURLIDAR_TRY_ASSIGN(from_scan, nearest_distances(whole, denser));
  line["points"] = count_returns(denser);
  line["to_scan"] = to_json(summarise(to_scan));
  line["from_scan"] = to_json(summarise(from_scan));
  line["to_scan_percentiles"] = percentiles_of(std::move(to_scan));
  line["from_scan_percentiles"] = percentiles_of(std::move(from_scan));
  print_line(line);
  return {};
}

/// Directions of the kept returns and between their rings.
std::vector<Vec3> denser_directions(const RingSplit& split, std::uint32_t every) {
  Detection rings;
  rings.sensor = split.sensor;
  rings.ring_elevations = split.elevations;
  const std::size_t all = split.elevations.size() * every * split.sensor.columns;
  std::vector<Vec3> directions = rays_between(rings, every, all);
  for (const Vec3& p : split.coded.positions) directions.push_back(p * (1 / norm(p)));
  return directions;
}

/// The points that a method tells in the directions.
Cloud points_told(const Method& method, const std::vector<Vec3>& directions) {
  const std::vector<RangeEstimate> told = method.sampler->tell(directions);
  Cloud cloud;
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (told[i].valid()) cloud.positions.push_back(directions[i] * told[i].range_m);
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  return cloud;
}

}  // namespace

Status nearest(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(every, arguments.number("every", 4, 2, 16));
  CURLIDAR_TRY_ASSIGN(scan, read_scan(arguments));
  CURLIDAR_TRY_ASSIGN(detection, scan.settings.sensor
                                     ? assign_rings(scan.cloud, *scan.settings.sensor)
                                     : detect_sensor(scan.cloud));
  if (detection.source == RingSource::uniform || detection.sensor.rings.size() <= 2 * every) {
    print_line({{"skipped", "the rings of the scan cannot be told, or are too few"}});
    return {};
  }
  const RingSplit split = split_rings(scan.cloud, detection, every);
  print_line({{"rings", detection.sensor.rings.size()},
              {"rings_coded", split.sensor.rings.size()},
              {"returns_coded", split.coded.size()}});

  EncodeSettings paper = for_fewer_rings(scan.settings, split.sensor, every);
  paper.paper.upsample_rows = every;
  paper.paper.upsample_columns = 1;
  CURLIDAR_TRY_ASSIGN(upsampled, upsample_scan(split.coded, paper));
  CURLIDAR_TRY_ASSIGN(limits, limits_of(split.coded, paper));
  PaperSettings within = paper.paper;
  within.max_range = {};
  within.min_range_m = limits.min_m;
  within.max_range.metres = limits.max_m;
  const Cloud whole = in_range(scan.cloud, within);
  CURLIDAR_TRY(print_distances({{"method", "paper"}}, in_range(upsampled.cloud, within), whole));

  const MethodInput input{.cloud = &split.coded,
                          .paper = paper,
                          .compact_sensor = split.sensor,
                          .ring_of_point = split.ring_of_point,
                          .ring_elevations = split.elevations,
                          .columns = split.sensor.columns};
  const std::vector<Vec3> directions = denser_directions(split, every);
  std::vector<Method> methods{edge_aware_method(input)};
  for (Method& method : compact_methods(input)) methods.push_back(std::move(method));
  for (const Method& method : methods) {
    if (!method.sampler) {
      print_line(method.header());
      continue;
    }
    const Cloud denser = in_range(points_told(method, directions), within);
    CURLIDAR_TRY(print_distances(method.header(), denser, whole));
  }
  return {};
}

}  // namespace curlidar::bench
