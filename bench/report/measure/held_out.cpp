// SPDX-License-Identifier: BSD-3-Clause
// Reconstruction between the rings of a real scan: rings 0, K, 2K .. are coded, the returns of the
// rings between them are predicted along their own beams.
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/try.hpp"
#include "protocol/ring_split.hpp"
#include "report/measure/calibrated.hpp"
#include "protocol/held_out_lines.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/methods.hpp"
#include "report/measure/own_scan.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

constexpr double kHalf = 0.5;  // completeness at which the most trusted are judged

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

/// Prints what a method tells, within the paper's limits and (`whole`) within none.
void print_method(Json line, const std::vector<RangeEstimate>& told,
                  const std::vector<RangeEstimate>& edge_aware, const Judge& limited,
                  const Judge& whole) {
  line.update(to_json(limited.errors(told)));
  line["whole"] = to_json(whole.errors(told));
  line["whole"]["equal"] = to_json(whole.equal_cut(told, edge_aware));
  if (line["method"].get<std::string>().starts_with("compact") &&
      line["method"] != "compact-field") {
    line["half"] = to_json(whole.most_trusted(told, kHalf));
    line["confidence"] = to_json(whole.confidence(told));
    line["trades"] = to_json(whole.trades(told));
  }
  print_line(line);
}

/// The methods, edge-aware interpolation the last one, then the same calibrated.
void print_methods(const std::vector<Method>& methods, const RingSplit& split,
                   const AskedLines& asked, const RangeLimits& limits) {
  const Judge limited(asked.true_m, limits), whole(asked.true_m, {});
  const std::vector<RangeEstimate> edge_aware = methods.back().sampler->along(asked.lines);
  for (const Method& method : methods) {
    if (!method.sampler) {
      print_line(method.header());
    } else {
      print_method(method.header(), method.sampler->along(asked.lines), edge_aware, limited, whole);
    }
  }
  print_method({{"method", "edge-aware-calibrated"}, {"setting", "raw samples"}},
               calibrated(edge_aware, split.held_out, asked.true_m, split.held_out_ring),
               edge_aware, limited, whole);
}

}  // namespace

Status held_out(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(every, arguments.number("every", 2, 2, 64));
  CURLIDAR_TRY_ASSIGN(profile, density_profile_of(arguments, "profile"));
  CURLIDAR_TRY_ASSIGN(confidence, density_profile_of(arguments, "confidence"));
  CURLIDAR_TRY_ASSIGN(scan, read_scan(arguments));
  CURLIDAR_TRY_ASSIGN(own, own_scan(scan));
  if (const std::string reason = why_not(own.rings, every); !reason.empty()) {
    print_line({{"skipped", reason}});
    return {};
  }
  const RingSplit split = split_rings(own.cloud, own.rings, every);
  const BeamModel* beams = beams_of(own);
  const EncodeSettings paper = for_fewer_rings(scan.settings, split.sensor, every);
  CURLIDAR_TRY_ASSIGN(limits, limits_of(split.coded, paper));
  print_line({{"preset", scan.preset},
              {"sensor", own.rings.sensor.name},
              {"rings_from", to_string(own.rings.source)},
              {"rings", own.rings.sensor.rings.size()},
              {"rings_coded", split.sensor.rings.size()},
              {"returns_coded", split.coded.size()},
              {"returns_held_out", split.held_out.size()},
              {"gaps", split.gaps.size()},
              {"motion_undone", own.motion_undone},
              {"beams_known", beams != nullptr},
              {"min_range_m", limits.min_m},
              {"max_range_m", limits.max_m}});
  const MethodInput input{.cloud = &split.coded,
                          .paper = paper,
                          .compact_sensor = split.sensor,  // or it might find the whole sensor
                          .ring_of_point = split.ring_of_point,
                          .ring_elevations = split.elevations,
                          .columns = split.sensor.columns,
                          .profile = std::move(profile),
                          .confidence = std::move(confidence)};
  std::vector<Method> methods = fine_methods(input);
  for (Method& method : make_methods(input)) methods.push_back(std::move(method));
  print_methods(methods, split, lines_of(split, beams), limits);
  return {};
}

}  // namespace curlidar::bench
