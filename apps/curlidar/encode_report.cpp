// SPDX-License-Identifier: BSD-3-Clause
#include "encode_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common_compact.hpp"

namespace curlidar::app {
namespace {

Json paper_json(const EncodeReport& report, const std::string& preset) {
  Json degrees = Json::object();
  for (std::size_t d = 0; d < report.degrees.size(); ++d) {
    if (report.degrees[d] != 0) degrees[std::to_string(d)] = report.degrees[d];
  }
  return {{"preset", preset},
          {"cp_paper_percent", report.cp_paper_percent},
          {"coefficients", report.coefficients},
          {"patches", report.patches},
          {"degrees", degrees},
          {"points_upsampled", report.points_upsampled}};
}

Json compact_json(const CompactReport& c) {
  return {{"mean_error_m", c.mean_error_m},
          {"rms_error_m", c.rms_error_m},
          {"max_error_m", c.max_error_m},
          {"error_nn_m", c.error_nn_m ? Json(*c.error_nn_m) : Json()},
          {"bits_per_point_coded", c.bits_per_point_coded},
          {"step_m", c.step_m},
          {"residual_step_m", c.residual_step_m},
          {"rows", c.rows},
          {"columns", c.columns},
          {"segments", c.segments},
          {"cell_centres", c.cell_centres},
          {"heights", c.heights},
          {"range_offsets", c.range_offsets},
          {"encodings", c.encodings},
          {"breakdown", breakdown_json(c.breakdown)},
          {"statistics", statistics_json(c.statistics)}};
}

Json records_json(const RecordReport& r) {
  return {{"lattice", to_string(r.lattice)},
          {"table", r.table.empty() ? Json() : Json(r.table)},
          {"motion", r.motion},
          {"share_on_lattice", r.share_on_lattice},
          {"residual_mm",
           {{"across", 1e3 * r.across_m}, {"up", 1e3 * r.up_m}, {"range", 1e3 * r.range_m}}},
          {"firings", r.firings},
          {"slots", r.slots},
          {"range_unit_m", r.range_unit_m},
          {"loose", r.loose},
          {"corrected", r.corrected},
          {"bound_m", r.promise.bound_m > 0 ? Json(r.promise.bound_m) : Json()},
          {"bit_exact", r.promise.bit_exact},
          {"any_order", r.promise.any_order},
          {"bytes",
           {{"rays", r.bytes.rays},
            {"directions", r.bytes.directions},
            {"loose", r.bytes.loose},
            {"corrections", r.bytes.corrections},
            {"order", r.bytes.order},
            {"attributes", r.bytes.attributes}}},
          {"notes", r.notes}};
}

std::string drop_text(std::size_t count, const EncodeReport& report, const char* reason) {
  const double share = 100.0 * static_cast<double>(count) /
                       static_cast<double>(std::max<std::size_t>(report.points_in, 1));
  return fmt::format("{:>10}  {:4.1f} %  {}\n", count_text(count), share, reason);
}

std::string paper_text(const EncodeReport& report, const std::string& preset) {
  Table table;
  table.add({"preset", preset});
  table.add({"CP of the paper", fmt::format("{:.2f} %", report.cp_paper_percent)});
  table.add({"patches", count_text(report.patches)});
  table.add({"coefficients", count_text(report.coefficients)});
  return table.text();
}

std::string compact_text(const EncodeReport& report) {
  const CompactReport& c = *report.compact;
  Table table;
  table.add({"mean error", length_text(c.mean_error_m)});
  table.add({"rms error", length_text(c.rms_error_m)});
  table.add({"largest error", length_text(c.max_error_m)});
  if (c.error_nn_m) table.add({"nearest-neighbour error", length_text(*c.error_nn_m)});
  if (c.rows == 0) return table.text();  // points one after the other
  table.add({"grid", fmt::format("{} rings x {}{}", c.rows, c.columns,
                                 c.cell_centres ? ", the input's own" : "")});
  table.add(
      {"steps",
       fmt::format("{}{}", length_text(c.step_m),
                   c.residual_step_m > 0 ? ", residual " + length_text(c.residual_step_m) : "")});
  table.add({"segments", count_text(c.segments)});
  table.add({"encodings tried", count_text(c.encodings)});
  return table.text();
}

/// What the directions of a file with every return are.
std::string lattice_text(const RecordReport& r) {
  switch (r.lattice) {
    case RecordLattice::none:
      return "none: points one after the other";
    case RecordLattice::rings:
      return r.bytes.directions > 0 ? "rings on even columns, points beside them"
                                    : "rings on even columns";
    case RecordLattice::rays:
      return r.table.empty() ? "rays, found or given, kept in the file"
                             : fmt::format("rays of the known table {}", r.table);
  }
  return "";
}

std::string share_of(std::size_t part, std::size_t all) {
  return fmt::format(
      "{}, {:.2f} %", count_text(part),
      100 * static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(all, 1)));
}

std::string records_text(const EncodeReport& report) {
  const RecordReport& r = *report.records;
  std::vector<std::pair<std::string, std::string>> lines;
  lines.push_back({"promise", promise_text(r.promise)});
  lines.push_back({"directions", lattice_text(r)});
  if (r.lattice == RecordLattice::rays) {
    lines.push_back({"points on it", fmt::format("{:.2f} %", 100 * r.share_on_lattice)});
    lines.push_back({"medians of their distances from it",
                     fmt::format("{} across, {} up, {} along", length_text(r.across_m),
                                 length_text(r.up_m), length_text(r.range_m))});
    lines.push_back(
        {"firings", fmt::format("{} at {} positions", count_text(r.firings), count_text(r.slots))});
    lines.push_back(
        {"range unit", r.range_unit_m > 0 ? length_text(r.range_unit_m) : "none found"});
    lines.push_back({"motion compensation", r.motion ? "undone" : "none found"});
  }
  if (r.lattice != RecordLattice::none) {
    lines.push_back({"points without a cell", share_of(r.loose, report.points_in)});
    lines.push_back({"points corrected", share_of(r.corrected, report.points_in)});
  }
  std::string text = "Every return:\n" + lines_text(lines);
  for (const std::string& note : r.notes) text += fmt::format("  note: {}\n", note);
  return text;
}

/// Bytes of everything in the file, or bits if nothing tells them apart.
std::string parts_text(const EncodeReport& report) {
  const std::string geometry =
      "Geometry:\n" + breakdown_text(report.compact->breakdown, report.points_coded);
  if (!report.records) return geometry;
  const RecordBytes& bytes = report.records->bytes;
  Table table;
  const auto add = [&](const char* name, std::size_t size) {
    if (size == 0) return;
    const double bits = 8.0 * static_cast<double>(size) /
                        static_cast<double>(std::max<std::size_t>(report.points_in, 1));
    table.add({name, bytes_text(size), fmt::format("{:.4f} bits a point", bits),
               fmt::format("{:.1f} %",
                           100.0 * static_cast<double>(size) / static_cast<double>(report.bytes))});
  };
  const std::size_t beside = bytes.directions + bytes.loose + bytes.corrections + bytes.order;
  const auto all_geometry = static_cast<std::size_t>(report.compact->breakdown.total() / 8 + 0.5);
  add(report.compact->rows == 0 ? "container" : "image",
      all_geometry - std::min(all_geometry, beside + bytes.rays));
  add("rays", bytes.rays);
  add("directions", bytes.directions);
  add("points without a cell", bytes.loose);
  add("corrections", bytes.corrections);
  add("order", bytes.order);
  add("attributes", bytes.attributes);
  add("metadata", report.bytes - std::min(report.bytes, all_geometry + bytes.attributes));
  const std::string parts = "Parts of the file:\n" + table.text();
  return report.compact->rows == 0 ? parts : parts + geometry;
}

std::string dropped_text(const EncodeReport& report) {
  const ProjectionCounts& counts = report.projection;
  if (report.points_coded == report.points_in) return "";
  std::string text = "Returns that are not coded one for one:\n";
  text += drop_text(counts.out_of_range, report, "out of range");
  text += drop_text(counts.out_of_fov, report, "outside the nominal field of view");
  if (!report.compact) text += drop_text(counts.outliers, report, "outliers (too few neighbours)");
  text += drop_text(counts.collided, report, "share a cell with a return nearer its centre");
  if (counts.kept > report.points_coded) {
    text += drop_text(counts.kept - report.points_coded, report, "not explained by the fit");
  }
  if (!report.compact && counts.out_of_range * 2 > report.points_in) {
    text +=
        "Most returns are out of range: --preset indoor, or --min-range and --max-range, keep "
        "them.\n";
  }
  return text;
}

}  // namespace

Json encode_json(const EncodeReport& report, Profile profile, const std::string& preset) {
  Json stages = Json::object();
  for (const StageTime& stage : report.stages_ms) stages[stage.stage] = stage.ms;
  const ProjectionCounts& counts = report.projection;
  Json json = {{"profile", to_string(profile)}, {"sensor", report.sensor},
               {"points_in", report.points_in}, {"points_coded", report.points_coded},
               {"bytes", report.bytes},         {"bits_per_point", report.bits_per_point}};
  json.update(report.compact ? compact_json(*report.compact) : paper_json(report, preset));
  if (report.records) json["records"] = records_json(*report.records);
  json["dropped"] = {{"outliers", counts.outliers},
                     {"out_of_range", counts.out_of_range},
                     {"out_of_fov", counts.out_of_fov},
                     {"collided", counts.collided}};
  json["stages_ms"] = stages;
  return json;
}

std::string encode_text(const Job& job, const EncodeReport& report, Profile profile,
                        const std::string& preset) {
  Table table;
  table.add({"profile", to_string(profile)});
  table.add({"sensor", report.sensor});
  table.add({"points in", count_text(report.points_in)});
  table.add({"points coded", count_text(report.points_coded)});
  table.add({"size", bytes_text(report.bytes)});
  table.add({"bits per point in", fmt::format("{:.2f}", report.bits_per_point)});
  std::string text = fmt::format("{} -> {}\n{}", job.input, job.output, table.text());
  text += report.compact ? compact_text(report) : paper_text(report, preset);
  if (report.records) text += records_text(report);
  if (report.compact) text += parts_text(report);
  text += dropped_text(report);
  Table stages;
  double total = 0;
  for (const StageTime& stage : report.stages_ms) {
    stages.add({stage.stage, milliseconds_text(stage.ms)});
    total += stage.ms;
  }
  stages.add({"total", milliseconds_text(total)});
  return text + "Time:\n" + stages.text();
}

std::string encode_line(const Job& job, const EncodeReport& report) {
  return fmt::format("{} -> {}  {} points, {}, {:.2f} bits a point\n", job.input, job.output,
                     count_text(report.points_in), bytes_text(report.bytes), report.bits_per_point);
}

}  // namespace curlidar::app
