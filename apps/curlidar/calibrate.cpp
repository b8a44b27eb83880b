// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/calibrate.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "commands.hpp"
#include "common_inputs.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar calibrate scan.pcd                     what the sensor is, how well the scan fits it
  curlidar calibrate drive/*.pcd -o mine.toml     one profile from many scans: more exact
  curlidar encode scan.pcd --sensor mine.toml
Scans of a spinning sensor as its driver made them, motion-compensated or not, lie on a lattice of
beams, encoder positions and range units. Coded on it they are exact and need far fewer bits.)";

struct Options {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string output, name, format, sensor = "auto";
  bool no_motion = false;
};

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

/// The smallest and the largest of something of the rings.
template <class Get>
std::pair<double, double> extent(const SensorProfile& sensor, const Get& get) {
  std::pair<double, double> out{get(sensor.rings.front()), get(sensor.rings.front())};
  for (const Ring& ring : sensor.rings) {
    out.first = std::min(out.first, get(ring));
    out.second = std::max(out.second, get(ring));
  }
  return out;
}

std::string angles_text(const SensorProfile& sensor, double Ring::*member) {
  const auto [low, high] = extent(sensor, [&](const Ring& ring) { return ring.*member; });
  return fmt::format("{:+.2f} .. {:+.2f} deg", degrees(low), degrees(high));
}

std::string lengths_text(const SensorProfile& sensor, double Ring::*member) {
  const auto [low, high] = extent(sensor, [&](const Ring& ring) { return ring.*member; });
  return fmt::format("{:+.2f} .. {:+.2f} mm", low * 1e3, high * 1e3);
}

std::string sensor_text(const SensorCalibration& found) {
  const SensorProfile& sensor = found.sensor;
  Table table;
  const auto line = [&](const char* name, const std::string& text) {
    table.add({fmt::format("{:<12} {}", name, text)});
  };
  line("sensor", fmt::format("{}: {}", sensor.name, sensor.description));
  line("rings", fmt::format("{}, told by {}; {}", sensor.rings.size(), to_string(found.ring_source),
                            angles_text(sensor, &Ring::elevation)));
  line("encoder",
       fmt::format("{} positions a turn; beams look {} beside it", count_text(sensor.slots),
                   angles_text(sensor, &Ring::azimuth_offset)));
  line("origins",
       fmt::format("{} up, {} to the left", lengths_text(sensor, &Ring::vertical_offset_m),
                   lengths_text(sensor, &Ring::horizontal_offset_m)));
  line("range unit", sensor.range_unit_m > 0 ? fmt::format("{} mm", sensor.range_unit_m * 1e3)
                                             : std::string("none found"));
  return table.text();
}

std::string motion_text(const ScanOnLattice& scan) {
  if (!scan.compensated) return "none";
  return fmt::format("{}, {:.3f} deg", length_text(norm(scan.move)), degrees(norm(scan.turn)));
}

std::string residual_text(double median_m, double p95_m) {
  return fmt::format("{:.3f} / {:.3f}", median_m * 1e3, p95_m * 1e3);
}

std::string scans_text(const Options& options, const SensorCalibration& found) {
  Table table;
  table.add({"scan", "returns", "on lattice", "placed", "firings", "across", "up", "range",
             "motion undone"});
  for (std::size_t i = 0; i < found.scans.size(); ++i) {
    const ScanOnLattice& scan = found.scans[i];
    if (scan.placed == 0) {
      table.add({options.inputs[i], count_text(scan.returns), "no"});
      continue;
    }
    table.add({options.inputs[i], count_text(scan.returns),
               fmt::format("{:.2f} %", scan.share * 100), count_text(scan.placed),
               count_text(scan.firings), residual_text(scan.across_median_m, scan.across_p95_m),
               residual_text(scan.up_median_m, scan.up_p95_m),
               residual_text(scan.range_median_m, scan.range_p95_m), motion_text(scan)});
  }
  return table.text() + "  (across, up, range: distances from the lattice, median / 95 %, mm)\n";
}

Json scan_json(const std::string& input, const ScanOnLattice& scan) {
  Json json = {{"input", input},
               {"returns", scan.returns},
               {"on_lattice", scan.placed > 0},
               {"share", scan.share},
               {"placed", scan.placed},
               {"firings", scan.firings},
               {"across_m", {{"median", scan.across_median_m}, {"p95", scan.across_p95_m}}},
               {"up_m", {{"median", scan.up_median_m}, {"p95", scan.up_p95_m}}},
               {"range_m", {{"median", scan.range_median_m}, {"p95", scan.range_p95_m}}},
               {"motion", nullptr},
               {"notes", scan.notes}};
  if (scan.compensated) {
    json["motion"] = {
        {"turn_deg", {degrees(scan.turn.x), degrees(scan.turn.y), degrees(scan.turn.z)}},
        {"move_m", {scan.move.x, scan.move.y, scan.move.z}}};
  }
  return json;
}

Json report_json(const Options& options, const SensorCalibration& found) {
  const SensorProfile& sensor = found.sensor;
  Json rings = Json::array();
  for (const Ring& ring : sensor.rings) {
    rings.push_back({{"elevation_deg", degrees(ring.elevation)},
                     {"azimuth_offset_deg", degrees(ring.azimuth_offset)},
                     {"vertical_offset_m", ring.vertical_offset_m},
                     {"horizontal_offset_m", ring.horizontal_offset_m},
                     {"range_phase_m", ring.range_phase_m}});
  }
  Json scans = Json::array();
  for (std::size_t i = 0; i < found.scans.size(); ++i) {
    scans.push_back(scan_json(options.inputs[i], found.scans[i]));
  }
  return {{"output", options.output.empty() ? Json(nullptr) : Json(options.output)},
          {"name", sensor.name},
          {"description", sensor.description},
          {"ring_source", to_string(found.ring_source)},
          {"slots", sensor.slots},
          {"range_unit_m", sensor.range_unit_m},
          {"rings", rings},
          {"scans", scans}};
}

/// --name, or the name of the file that is written, or of the sensor that was given.
std::string name_of(const Options& options) {
  if (!options.name.empty()) return options.name;
  if (!options.output.empty() && options.output != "-") return stem_of(options.output);
  return "calibrated";
}

SensorCalibration calibrate_files(const Options& options) {
  SensorCalibrationSettings settings;
  settings.name = name_of(options);
  settings.start = parse_sensor(options.sensor);
  settings.motion = !options.no_motion;
  settings.threads = options.common.threads;
  ProgressBar bar(!options.common.quiet);
  settings.progress = [&](std::string_view stage, double fraction) {
    bar.update(0, 1, stage, fraction);
  };
  const auto format = parse_format(options.format);
  std::vector<Cloud> clouds;
  for (const std::string& input : options.inputs) {
    if (!options.output.empty()) refuse_same_file(input, options.output);
    clouds.push_back(load_cloud(input, format));
  }
  try {
    return need(calibrate_sensor(clouds, settings));
  } catch (const Failure& failure) {
    const std::string& first = options.inputs.front();
    throw Failure({ErrorCode::unsupported,
                   fmt::format("{}{}: {}", first == "-" ? "standard input" : first,
                               options.inputs.size() > 1 ? " and others" : "", failure.what())},
                  failure.code());
  }
}

int run(const Options& options) {
  refuse_mixed_stdout(options.common, options.output);
  const SensorCalibration found = calibrate_files(options);
  if (!options.output.empty()) {
    const std::string toml = sensor_to_toml(found.sensor);
    need(write_file(options.output, std::as_bytes(std::span(toml.data(), toml.size()))));
  }
  print_result(options.common,
               {report_json(options, found), sensor_text(found) + scans_text(options, found)},
               options.output == "-");
  for (std::size_t i = 0; i < found.scans.size(); ++i) {
    if (found.scans[i].placed > 0 || options.common.quiet) continue;
    print_warning(fmt::format("{} does not lie on the lattice that the other scans share",
                              options.inputs[i]));
  }
  return kExitOk;
}

}  // namespace

Command add_calibrate(CLI::App& root) {
  CLI::App* app = root.add_subcommand(
      "calibrate", "Find a sensor's exact beams from its scans, as a profile for --sensor");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("inputs", options->inputs, "Scans of one sensor; - is standard input")
      ->required();
  app->add_option("-o,--output", options->output,
                  "The profile, a TOML file; - is standard output; default: none is written");
  app->add_option("--name", options->name, "Name of the profile; default: that of the file");
  app->add_option("--sensor", options->sensor,
                  "A profile whose rings are about right, for scans in which they are not found")
      ->capture_default_str();
  app->add_flag("--no-motion", options->no_motion, "The scans are not motion-compensated");
  app->add_option("--format", options->format,
                  fmt::format("Format of the inputs: {}; default by content", kFormatNames));
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
