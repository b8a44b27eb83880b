// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/simulate.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "simulate_drive.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar simulate -o street.pcd
  curlidar simulate --scene room --sensor vlp16 --seed 7 --noise 0 --dropout 0 -o room.pcd
  curlidar simulate -o scan.pcd --truth-output truth.pcd --truth-rows 8
  curlidar simulate --drive --scans 200 --truth -o drive/    # scans, poses, the exact surface
The truth is exact (no noise, no dropouts) and lies on the grid that 'decode --rows R --cols C' of
the encoded scan has, so that both can be compared direction by direction.)";

struct Options {
  CommonOptions common;
  std::string scene = "street", sensor = "hdl64e-kitti", output = "scan.pcd", to_format;
  SimulateSettings simulate;
  DriveOptions drive;
  std::string truth_output, grid_rows = "uniform";
  std::uint32_t grid_columns = 1024;
  double truth_rows = 1, truth_columns = 1, truth_min_range_m = 0;
};

Lattice truth_lattice(const Options& options, const SensorProfile& sensor) {
  const RowChoice choice = parse_rows(options.grid_rows, "--grid-rows");
  if (choice.rule == RowRule::rings) {
    return Lattice::from_rings(sensor.elevations(), options.grid_columns);
  }
  const auto rings = static_cast<std::uint32_t>(sensor.rings.size());
  return Lattice::uniform(choice.rows != 0 ? choice.rows : rings, options.grid_columns,
                          sensor.fov_up, sensor.fov_down);
}

void check_outputs(const Options& options) {
  refuse_mixed_stdout(options.common, options.output);
  refuse_mixed_stdout(options.common, options.truth_output);
  if (options.output == options.truth_output) {
    usage_error(fmt::format("both clouds would go to {}", options.output));
  }
}

int run(const Options& options) {
  check_outputs(options);
  const SensorProfile sensor = need_option(load_sensor(options.sensor));
  SimulateSettings settings = options.simulate;
  settings.threads = options.common.threads;
  if (options.drive.drive) {
    DriveOptions drive = options.drive;
    drive.to_format = options.to_format;
    return run_drive(options.common, drive, settings, sensor, options.output);
  }
  const auto scene = need_option(make_scene(options.scene, settings.seed));
  const Lattice lattice = truth_lattice(options, sensor);
  WriteOptions write_options;
  write_options.format = parse_format(options.to_format);

  const Cloud cloud = need(simulate(*scene, sensor, settings));
  save_cloud(options.output, cloud, write_options);
  Json json = {{"output", options.output},
               {"scene", options.scene},
               {"sensor", sensor.name},
               {"seed", settings.seed},
               {"points", cloud.size()}};
  std::string text = fmt::format("{}: {} points of a {} seen by {}\n", options.output,
                                 count_text(cloud.size()), options.scene, sensor.name);
  if (!options.truth_output.empty()) {
    const Cloud truth =
        need(simulate_truth(*scene, lattice, options.truth_rows, options.truth_columns,
                            options.truth_min_range_m, sensor.max_range_m, settings.threads));
    save_cloud(options.truth_output, truth, write_options);
    json["truth_output"] = options.truth_output;
    json["truth_points"] = count_returns(truth);
    text += fmt::format("{}: {} x {} exact directions, {} of them with a surface\n",
                        options.truth_output, truth.height, truth.width,
                        count_text(count_returns(truth)));
  }
  print_result(options.common, {json, text}, options.output == "-" || options.truth_output == "-");
  return kExitOk;
}

void add_truth_options(CLI::App& app, Options& options) {
  const char* group = "Exact truth";
  const auto factor = number_in(1e-3, 65536.0);
  app.add_option("--truth-output", options.truth_output, "Write the exact cloud too, organised")
      ->group(group);
  app.add_option("--truth-rows", options.truth_rows, "R_row: factor on the grid's rows")
      ->capture_default_str()
      ->check(factor)
      ->group(group);
  app.add_option("--truth-cols", options.truth_columns, "R_col: factor on its columns")
      ->capture_default_str()
      ->check(factor)
      ->group(group);
  app.add_option("--truth-min-range", options.truth_min_range_m, "Leave out what is nearer, metres")
      ->capture_default_str()
      ->check(number_in(0.0, 1e6))
      ->group(group);
  app.add_option("--grid-rows", options.grid_rows, "Rows of the grid: uniform, rings or a number")
      ->capture_default_str()
      ->group(group);
  app.add_option("--grid-cols", options.grid_columns, "Columns of the grid")
      ->capture_default_str()
      ->check(number_in(4, 65536))
      ->group(group);
}

}  // namespace

Command add_simulate(CLI::App& root) {
  CLI::App* app = root.add_subcommand("simulate", "Simulate a scan, with exact truth if wanted");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("--scene", options->scene,
                  fmt::format("Scene: {}", fmt::join(scene_names(), ", ")))
      ->capture_default_str();
  app->add_option("--sensor", options->sensor,
                  "Sensor: a built-in name (see 'curlidar sensors'), or a .toml or Ouster .json "
                  "file")
      ->capture_default_str();
  app->add_option("--seed", options->simulate.seed, "Places objects, noise and dropouts")
      ->capture_default_str();
  app->add_option("--noise", options->simulate.range_noise_m, "Standard deviation of range, metres")
      ->capture_default_str()
      ->check(number_in(0.0, 100.0));
  app->add_option("--dropout", options->simulate.dropout, "Share of returns lost at random")
      ->capture_default_str()
      ->check(number_in(0.0, 1.0));
  app->add_option("--range-unit", options->simulate.range_unit_m,
                  "Round ranges to multiples of this, metres; 0 = exact")
      ->capture_default_str()
      ->check(number_in(0.0, 100.0));
  app->add_option("-o,--output", options->output, "Cloud to write; - is standard output")
      ->capture_default_str();
  app->add_option("--to-format", options->to_format,
                  fmt::format("Its format: {}; default by extension", kFormatNames));
  add_truth_options(*app, *options);
  add_drive_options(*app, options->drive);
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
