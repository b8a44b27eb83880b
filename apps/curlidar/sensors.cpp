// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/sensor.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "commands.hpp"
#include "common_inputs.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar sensors                     the built-in sensors
  curlidar sensors vlp16 >mine.toml    a profile to edit
  curlidar encode scan.pcd --sensor mine.toml)";

struct Options {
  CommonOptions common;
  std::string name;
};

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

Json sensor_json(const SensorProfile& sensor) {
  std::vector<double> elevations_deg;
  for (const double elevation : sensor.elevations()) elevations_deg.push_back(degrees(elevation));
  return {{"name", sensor.name},
          {"description", sensor.description},
          {"rings", sensor.rings.size()},
          {"columns", sensor.columns},
          {"fov_up_deg", degrees(sensor.fov_up)},
          {"fov_down_deg", degrees(sensor.fov_down)},
          {"min_range_m", sensor.min_range_m},
          {"max_range_m", sensor.max_range_m},
          {"elevations_deg", elevations_deg}};
}

int list(const Options& options) {
  Json all = Json::array();
  std::string text;
  for (const std::string& name : builtin_sensor_names()) {
    const SensorProfile sensor = need(builtin_sensor(name));
    all.push_back(sensor_json(sensor));
    text += fmt::format("{:<15} {:>4} rings {:>6} columns {:>+7.2f} .. {:>+7.2f} deg  {}\n", name,
                        sensor.rings.size(), sensor.columns, degrees(sensor.fov_up),
                        degrees(sensor.fov_down), sensor.description);
  }
  print_result(options.common, {all, text});
  return kExitOk;
}

int run(const Options& options) {
  if (options.name.empty()) return list(options);
  const std::optional<SensorProfile> sensor = parse_sensor(options.name);
  if (!sensor) usage_error("'auto' is found in a scan: see 'curlidar info SCAN'");
  print_result(options.common, {sensor_json(*sensor), sensor_to_toml(*sensor)});
  return kExitOk;
}

}  // namespace

Command add_sensors(CLI::App& root) {
  CLI::App* app = root.add_subcommand("sensors", "List the built-in sensors, or print one as TOML");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("name", options->name, "A built-in name, or a .toml or Ouster .json file");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
