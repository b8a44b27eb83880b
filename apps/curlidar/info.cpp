// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "commands.hpp"
#include "common_compact.hpp"
#include "common_inputs.hpp"
#include "common_maps.hpp"
#include "curlidar/sequence.hpp"
#include "info_sequence.hpp"
#include "map.hpp"
#include "one_scan.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar info scan.bin                        what --sensor auto sees
  curlidar info scan.pcd --sensor os1-64        the same scan through a given profile
  curlidar info scan.curl --json
  curlidar info drive.curl --poses-out poses.txt   every scan of a sequence, and its poses
  curlidar info map.curl                        as 'curlidar map info')";

struct Options {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string format, sensor = "auto";
  SequenceInfoOptions sequence;
};

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

std::vector<double> elevations_deg(const SensorProfile& sensor) {
  std::vector<double> values;
  for (const double elevation : sensor.elevations()) values.push_back(degrees(elevation));
  return values;
}

/// "  ring 0   +2.00 +1.66 ..." eight to a line.
std::string elevation_table(const std::vector<double>& elevations) {
  constexpr std::size_t kPerLine = 8;
  std::string text = "elevations, degrees, from the top ring:\n";
  for (std::size_t i = 0; i < elevations.size(); i += kPerLine) {
    text += fmt::format("  {:>4}:", i);
    for (std::size_t j = i; j < std::min(i + kPerLine, elevations.size()); ++j) {
      text += fmt::format(" {:>+7.2f}", elevations[j]);
    }
    text += '\n';
  }
  return text;
}

std::string attribute_names(const std::vector<Attribute>& attributes) {
  std::string text;
  for (const Attribute& attribute : attributes) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", attribute.name,
                        to_string(type_of(attribute.values)));
  }
  return text.empty() ? "none" : text;
}

Json attribute_json(const std::vector<Attribute>& attributes) {
  Json json = Json::array();
  for (const Attribute& attribute : attributes) {
    json.push_back({{"name", attribute.name},
                    {"type", to_string(type_of(attribute.values))},
                    {"components", attribute.components}});
  }
  return json;
}

Json scan_json(const Cloud& cloud, const Detection& found) {
  const bool spinning = found.sensor.pattern == ScanPattern::spinning;
  return {{"kind", "scan"},
          {"sensor", found.sensor.name},
          {"pattern", spinning ? "spinning" : "limited-field"},
          {"ring_source", to_string(found.source)},
          {"rings", found.sensor.rings.size()},
          {"columns", found.sensor.columns},
          {"fov_up_deg", degrees(found.sensor.fov_up)},
          {"fov_down_deg", degrees(found.sensor.fov_down)},
          {"elevations_deg", elevations_deg(found.sensor)},
          {"elevation_min_deg", degrees(found.elevation_min)},
          {"elevation_max_deg", degrees(found.elevation_max)},
          {"slots", found.points},
          {"returns", found.returns},
          {"not_finite", found.not_finite},
          {"zero", found.zero},
          {"width", cloud.width},
          {"height", cloud.height},
          {"organised", cloud.organised()},
          {"occupancy", found.occupancy},
          {"azimuth_coverage", found.azimuth_coverage},
          {"range_m",
           {{"min", found.range_min_m},
            {"p50", found.range_p50_m},
            {"p90", found.range_p90_m},
            {"max", found.range_max_m}}},
          {"attributes", attribute_json(cloud.attributes)},
          {"metadata", cloud.metadata},
          {"notes", found.notes}};
}

std::string scan_text(const std::string& name, const Cloud& cloud, const Detection& found) {
  const SensorProfile& sensor = found.sensor;
  std::string text = fmt::format("{}\n", name);
  const auto line = [&](const char* key, const std::string& value) {
    text += fmt::format("  {:<12} {}\n", key, value);
  };
  line("sensor", sensor.name + (sensor.description.empty() ? "" : ": " + sensor.description));
  line("rings", fmt::format("{}, told by {}", sensor.rings.size(), to_string(found.source)));
  line("columns", fmt::format("{}", sensor.columns));
  line("field",
       fmt::format("{:+.2f} .. {:+.2f} deg nominal, {:+.2f} .. {:+.2f} deg seen, "
                   "{:.0f} % of the turn",
                   degrees(sensor.fov_up), degrees(sensor.fov_down), degrees(found.elevation_max),
                   degrees(found.elevation_min), found.azimuth_coverage * 100));
  line("returns",
       fmt::format("{} of {} slots; {} not finite, {} at (0, 0, 0)", count_text(found.returns),
                   count_text(found.points), count_text(found.not_finite), count_text(found.zero)));
  line("layout", cloud.organised()
                     ? fmt::format("organised, {} x {} (width x height)", cloud.width, cloud.height)
                     : "unorganised");
  line("occupancy", fmt::format("{:.1f} % of rings x columns", found.occupancy * 100));
  line("range",
       fmt::format("{:.2f} m .. {:.2f} m, median {:.2f} m, p90 {:.2f} m", found.range_min_m,
                   found.range_max_m, found.range_p50_m, found.range_p90_m));
  line("attributes", attribute_names(cloud.attributes));
  for (const auto& [key, value] : cloud.metadata) line("metadata", key + " = " + value);
  for (const std::string& note : found.notes) line("note", note);
  return text + elevation_table(elevations_deg(sensor));
}

Outcome describe_scan(const Job& job, std::span<const std::byte> bytes, const Options& options,
                      const std::optional<SensorProfile>& sensor) {
  ReadOptions read_options;
  read_options.format = parse_format(options.format);
  const std::string name = job.input == "-" ? "standard input" : job.input;
  const Cloud cloud = need(parse_cloud(bytes, name, read_options));
  const Detection found = detect(cloud, sensor);
  return {scan_json(cloud, found), scan_text(name, cloud, found)};
}

Json parameters_json(const PaperSettings& s) {
  Json max_range = s.max_range.metres;
  if (s.max_range.percentile > 0) max_range = fmt::format("p{:g}", s.max_range.percentile);
  return {{"upsample_rows", s.upsample_rows},
          {"upsample_columns", s.upsample_columns},
          {"patch", s.patch},
          {"overlap", s.overlap},
          {"max_degree", s.max_degree},
          {"accept_m", s.accept_m},
          {"reject_m", s.reject_m},
          {"k", s.k},
          {"cliff_row_m", s.cliffs.row_m},
          {"cliff_column_m", s.cliffs.column_m},
          {"cliff_diagonal_m", s.cliffs.diagonal_m},
          {"min_range_m", s.min_range_m},
          {"max_range", max_range},
          {"outlier_radius_m", s.outlier_radius_m},
          {"outlier_min_points", s.outlier_min_points},
          {"refused_triangle_share", s.refused_triangle_share},
          {"stop_on_total_error", s.stop_on_total_error},
          {"global_degree", s.global_degree},
          {"global_reject_m", s.global_reject_m}};
}

/// What a profile alone has to say: a JSON part and lines of text.
struct Details {
  Json json = Json::object();
  std::string text;
};

std::string parameters_text(const Json& parameters) {
  Table table;
  for (const auto& [key, value] : parameters.items()) {
    if (value.is_number_float()) {
      table.add({key, fmt::format("{:.6g}", value.get<double>())});
    } else {
      table.add({key, value.is_string() ? value.get<std::string>() : value.dump()});
    }
  }
  return table.text();
}

Details paper_details(const DecodedScan& scan) {
  const Json parameters = parameters_json(*scan.paper);
  return {
      {{"coefficients", scan.coefficients}, {"patches", scan.patches}, {"parameters", parameters}},
      fmt::format("fit: {} coefficients in {} patches\nparameters:\n{}",
                  count_text(scan.coefficients), count_text(scan.patches),
                  parameters_text(parameters))};
}

Details compact_details(const CompactContents& c) {
  const Json parameters = {{"step_m", c.step_m},         {"residual_step_m", c.residual_step_m},
                           {"root_cells", c.root_cells}, {"smallest_leaf", c.smallest_leaf},
                           {"bands", c.bands},           {"sectors", c.sectors},
                           {"heights", c.heights},       {"range_offsets", c.range_offsets}};
  return {{{"segments", c.bands * c.sectors},
           {"parameters", parameters},
           {"statistics", statistics_json(c.statistics)}},
          fmt::format("parameters:\n{}partition:\n{}", parameters_text(parameters),
                      statistics_text(c.statistics))};
}

Json beams_json(const SensorProfile& sensor) {
  Json beams = Json::array();
  for (const Ring& ring : sensor.rings) {
    beams.push_back({{"elevation_deg", degrees(ring.elevation)},
                     {"azimuth_offset_deg", degrees(ring.azimuth_offset)},
                     {"vertical_offset_m", ring.vertical_offset_m},
                     {"horizontal_offset_m", ring.horizontal_offset_m},
                     {"range_phase_m", ring.range_phase_m}});
  }
  return beams;
}

Json vector_json(const Vec3& v) {
  return {v.x, v.y, v.z};
}

Vec3 in_degrees(const Vec3& radians) {
  return {degrees(radians.x), degrees(radians.y), degrees(radians.z)};
}

Json motion_json(const std::optional<RecordMotion>& motion) {
  if (!motion) return nullptr;
  return {{"turn_deg", vector_json(in_degrees(motion->turn))},
          {"turn2_deg", vector_json(in_degrees(motion->turn2))},
          {"move_m", vector_json(motion->move)},
          {"move2_m", vector_json(motion->move2)},
          {"rigid_turn_deg", vector_json(in_degrees(motion->rigid_turn))},
          {"rigid_move_m", vector_json(motion->rigid_move)}};
}

std::string lattice_text(const RecordContents& r) {
  switch (r.lattice) {
    case RecordLattice::none:
      return "none, points one after the other";
    case RecordLattice::rings:
      return r.directions ? "rings on even columns, points beside them" : "rings on even columns";
    case RecordLattice::rays:
      return r.table.empty() ? "rays, kept in the file" : "rays of the known table " + r.table;
  }
  return "";
}

std::string motion_text(const RecordMotion& m) {
  const Vec3 turn = in_degrees(m.turn);
  return fmt::format(
      "undone; in one turn the sensor moved ({:+.3f}, {:+.3f}, {:+.3f}) m and rotated ({:+.3f}, "
      "{:+.3f}, {:+.3f}) deg",
      m.move.x, m.move.y, m.move.z, turn.x, turn.y, turn.z);
}

/// What a file with every return says of itself.
Details record_details(const RecordContents& r, const SensorProfile& sensor) {
  std::vector<std::pair<std::string, std::string>> lines;
  lines.push_back({"promise", promise_text(r.promise)});
  lines.push_back({"directions", lattice_text(r)});
  if (r.lattice == RecordLattice::rays) {
    lines.push_back(
        {"firings", fmt::format("{} at {} positions", count_text(r.firings), count_text(r.slots))});
    lines.push_back({"range unit", r.range_unit_m > 0 ? length_text(r.range_unit_m) : "not used"});
    lines.push_back({"motion compensation", r.motion ? motion_text(*r.motion) : "none"});
  }
  lines.push_back({"points without a cell", count_text(r.loose)});
  lines.push_back(
      {"cloud", fmt::format("{} slots, {} x {} (width x height), {}", count_text(r.slots_of_cloud),
                            r.width, r.height, to_string(r.coordinates))});
  const bool rays = r.lattice == RecordLattice::rays;
  const Json json = {{"lattice", to_string(r.lattice)},
                     {"table", r.table.empty() ? Json() : Json(r.table)},
                     {"directions", r.directions},
                     {"corrections", r.corrections},
                     {"firings", r.firings},
                     {"slots", r.slots},
                     {"range_unit_m", r.range_unit_m},
                     {"motion", motion_json(r.motion)},
                     {"beams", rays ? beams_json(sensor) : Json()},
                     {"loose", r.loose},
                     {"bound_m", r.promise.bound_m > 0 ? Json(r.promise.bound_m) : Json()},
                     {"bit_exact", r.promise.bit_exact},
                     {"any_order", r.promise.any_order},
                     {"cloud_slots", r.slots_of_cloud},
                     {"width", r.width},
                     {"height", r.height},
                     {"coordinates", to_string(r.coordinates)}};
  return {{{"records", json}}, "every return:\n" + lines_text(lines)};
}

/// What the profile, and every return if the file has them, have to say.
Details details_of(const DecodedScan& scan) {
  if (!scan.records) return scan.compact ? compact_details(*scan.compact) : paper_details(scan);
  Details details = record_details(*scan.records, scan.sensor);
  if (!scan.compact) return details;
  const Details image = compact_details(*scan.compact);
  details.json.update(image.json);
  details.text += image.text;
  return details;
}

/// Bytes of all chunks of a name together.
struct Part {
  std::string name;
  std::size_t chunks = 0, bytes = 0;
};

std::vector<Part> parts_of(const std::vector<ChunkInfo>& chunks, std::size_t file_bytes) {
  std::vector<Part> parts;
  std::size_t payloads = 0;
  for (const ChunkInfo& chunk : chunks) {
    const auto same = [&](const Part& part) { return part.name == chunk.name; };
    auto part = std::find_if(parts.begin(), parts.end(), same);
    if (part == parts.end()) part = parts.insert(part, {chunk.name, 0, 0});
    ++part->chunks;
    part->bytes += chunk.bytes;
    payloads += chunk.bytes;
  }
  parts.push_back({"container", 1, file_bytes - payloads});
  return parts;
}

double bits_a_return(std::size_t bytes, const DecodedScan& scan) {
  return 8.0 * static_cast<double>(bytes) /
         static_cast<double>(std::max<std::size_t>(scan.coded_returns, 1));
}

Outcome describe_curl(const Job& job, std::span<const std::byte> bytes, std::size_t threads) {
  DecodeOptions decode_options;
  decode_options.partition = true;
  decode_options.threads = threads;
  const DecodedScan scan = need(decode(bytes, decode_options));
  const std::vector<ChunkInfo> infos = need(list_chunks(bytes));
  Json chunks = Json::array(), parts = Json::array();
  for (const ChunkInfo& chunk : infos) {
    chunks.push_back({{"name", chunk.name}, {"offset", chunk.offset}, {"bytes", chunk.bytes}});
  }
  Table part_table;
  for (const Part& part : parts_of(infos, bytes.size())) {
    const double bits = bits_a_return(part.bytes, scan);
    parts.push_back({{"name", part.name},
                     {"chunks", part.chunks},
                     {"bytes", part.bytes},
                     {"bits_per_point", bits}});
    part_table.add({part.chunks > 1 ? fmt::format("{} x {}", part.name, part.chunks) : part.name,
                    bytes_text(part.bytes), fmt::format("{:.4f} bits a return", bits)});
  }
  const Lattice& lattice = scan.field->lattice();
  std::string text = fmt::format("{}\n", job.input == "-" ? "standard input" : job.input);
  const auto line = [&](const char* key, const std::string& value) {
    text += fmt::format("  {:<12} {}\n", key, value);
  };
  line("profile", to_string(scan.profile));
  const bool has_grid = scan.compact || scan.paper;
  if (has_grid) {
    line("sensor", fmt::format("{}, {} rings", scan.sensor.name, scan.sensor.rings.size()));
    line("grid", fmt::format("{} x {}, {} rows", lattice.rows(), lattice.columns(),
                             lattice.is_uniform() ? "uniform" : "ring"));
  }
  line("returns", fmt::format("{}, {}", count_text(scan.coded_returns),
                              scan.records ? "every one of the scan" : "those of a depth image"));
  line("attributes", attribute_names(scan.attributes));
  for (const auto& [key, value] : scan.metadata) line("metadata", key + " = " + value);
  line("size", fmt::format("{}, {:.3f} bits a return", bytes_text(bytes.size()),
                           bits_a_return(bytes.size(), scan)));
  text += "parts:\n" + part_table.text();
  Json json = {{"kind", "curl"},
               {"profile", to_string(scan.profile)},
               {"sensor", scan.sensor.name},
               {"rings", scan.sensor.rings.size()},
               {"rows", has_grid ? lattice.rows() : 0},
               {"columns", has_grid ? lattice.columns() : 0},
               {"every_return", scan.records.has_value()},
               {"points_coded", scan.coded_returns},
               {"bytes", bytes.size()},
               {"bits_per_point_coded", bits_a_return(bytes.size(), scan)},
               {"parts", parts},
               {"chunks", chunks},
               {"attributes", attribute_json(scan.attributes)},
               {"metadata", scan.metadata}};
  const Details details = details_of(scan);
  json.update(details.json);
  return {json, text + details.text};
}

int run(const Options& options) {
  const auto sensor = parse_sensor(options.sensor);
  parse_format(options.format);  // said wrongly, it is a matter of usage
  const SequenceInfoOptions& sequence = options.sequence;
  const bool writes = !sequence.poses_out.empty() || !sequence.times_out.empty();
  if (writes && (options.inputs.size() != 1 || !is_sequence_file(options.inputs.front()))) {
    usage_error("--poses-out and --times-out write what one sequence holds");
  }
  return for_each_job(
      options.common, plan_jobs(options.inputs), [&](const Job& job, const ProgressCallback&) {
        if (job.input != "-" && is_sequence_file(job.input)) {
          return describe_sequence(job.input, sequence);
        }
        if (job.input != "-" && is_map_file(job.input)) {
          return map_outcome(job.input, load_map(job.input, sequence.allow_truncated));
        }
        const std::vector<std::byte> bytes = need(read_file(job.input));
        refuse_many(job.input, bytes);
        return options.format.empty() && is_curl(bytes)
                   ? describe_curl(job, bytes, options.common.threads)
                   : describe_scan(job, bytes, options, sensor);
      });
}

}  // namespace

Command add_info(CLI::App& root) {
  CLI::App* app = root.add_subcommand("info", "What a scan or a .curl file holds");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("inputs", options->inputs, "Scans or .curl files; - is standard input")
      ->required();
  app->add_option("--sensor", options->sensor, kSensorHelp)->capture_default_str();
  app->add_option("--format", options->format,
                  fmt::format("Format of the input: {}; default by content", kFormatNames));
  app->add_option("--poses-out", options->sequence.poses_out,
                  "Of a sequence with poses: write them, as .csv, .tum or KITTI's lines")
      ->type_name("FILE");
  app->add_option("--times-out", options->sequence.times_out,
                  "Of a sequence with times: write them")
      ->type_name("FILE");
  app->add_flag("--allow-truncated", options->sequence.allow_truncated,
                "Take sequences and maps that are cut off as far as they go");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
