// SPDX-License-Identifier: BSD-3-Clause
// What a sensor of few rings comes to by the preset for sparse scans: every K-th ring of a scan is
// coded at 1 bit a return and made 64 and 128 rows, and judged by the rings that were left out.
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "base/try.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/reconstruct.hpp"
#include "report/measure/codecs.hpp"
#include "protocol/held_out_lines.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/judge.hpp"
#include "report/measure/own_scan.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

constexpr double kLeastConfidence = 0.2;  ///< that of `curlidar decode --preset sparse`
constexpr std::array kRows{64, 128};      ///< the preset's, and twice as many with --rows

/// What is told along the lines of the held-out rings with at least the preset's confidence.
RayErrors errors_of(const DecodedScan& scan, const AskedLines& asked) {
  std::vector<RangeEstimate> told(asked.lines.size());
  continuous_field(scan)->range_along(asked.lines, told);
  for (RangeEstimate& estimate : told) {
    if (estimate.confidence < kLeastConfidence) estimate.seen = Seen::unknown;
  }
  return Judge(asked.true_m, {}).errors(told);
}

Status print_rows(const DecodedScan& scan, int rows, const Cloud& held_out, Json line) {
  ReconstructSettings settings;
  settings.rows = rows / static_cast<double>(scan.field->lattice().rows());
  settings.min_confidence = kLeastConfidence;
  settings.keep_originals = true;
  CURLIDAR_TRY_ASSIGN(cloud, reconstruct(scan, settings));
  CURLIDAR_TRY_ASSIGN(distances, nearest_distances(held_out, cloud));
  line["rows"] = rows;
  line["points"] = count_returns(cloud);
  line["from_held_out"] = to_json(summarise(std::move(distances)));
  print_line(line);
  return {};
}

}  // namespace

Status sparse(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(every, arguments.number("every", 4, 2, 64));
  CURLIDAR_TRY_ASSIGN(scan, read_scan(arguments));
  CURLIDAR_TRY_ASSIGN(own, own_scan(scan));
  const RingSplit split = split_rings(own.cloud, own.rings, every);
  EncodeSettings settings = compact_of_scan(CompactTarget::bits_per_point, 1);
  settings.sensor = split.sensor;
  CURLIDAR_TRY_ASSIGN(encoded, encode(split.coded, settings));
  CURLIDAR_TRY_ASSIGN(decoded, decode(encoded.bytes));
  Json line{{"rings", own.rings.sensor.rings.size()},
            {"rings_coded", split.sensor.rings.size()},
            {"returns_coded", split.coded.size()},
            {"bits_per_point", encoded.report.bits_per_point}};
  line.update(to_json(errors_of(decoded, lines_of(split, beams_of(own)))));
  Cloud held_out;
  held_out.positions = split.held_out;
  for (const int rows : kRows) CURLIDAR_TRY(print_rows(decoded, rows, held_out, line));
  return {};
}

}  // namespace curlidar::bench
