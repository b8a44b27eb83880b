// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/project.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar project scan.bin                              64 uniform rows x 1024, 5 m .. p90
  curlidar project scan.pcd --rows rings --cols 2048 --min-range 1 --max-range 80 -o grid.pcd
The result is organised: one cell-centre point for each cell with a return, NaN elsewhere, so that
other codecs can be given exactly the input that the paper's pipeline sees.)";

struct Options {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string output, format, to_format, sensor = "auto", rows = "uniform", max_range = "p90";
  ProjectSettings project;
};

Json counts_json(const ProjectionCounts& counts, const Detection& found) {
  return {{"sensor", found.sensor.name},
          {"points_in", counts.returns},
          {"points", counts.kept},
          {"dropped",
           {{"out_of_range", counts.out_of_range},
            {"out_of_fov", counts.out_of_fov},
            {"collided", counts.collided}}}};
}

int run(const Options& options) {
  ProjectSettings settings = options.project;
  const RowChoice choice = parse_rows(options.rows, "--rows");
  settings.row_rule = choice.rule;
  settings.rows = choice.rows;
  settings.max_range = parse_range_limit(options.max_range, "--max-range");
  const auto sensor = parse_sensor(options.sensor);
  const auto format = parse_format(options.format);
  WriteOptions write_options;
  write_options.format = parse_format(options.to_format);
  const std::vector<Job> jobs = plan_jobs(options.inputs, options.output, ".projected.pcd");
  return for_each_job(options.common, jobs, [&](const Job& job, const ProgressCallback&) {
    const Cloud cloud = load_cloud(job.input, format);
    const Detection found = detect(cloud, sensor);
    ProjectionCounts counts;
    const Cloud grid = need(project(cloud, found, settings, &counts));
    save_cloud(job.output, grid, write_options);
    return Outcome{
        counts_json(counts, found),
        fmt::format("{} -> {}  {} of {} returns on {} x {} cells; {} out of range, {} outside the "
                    "field of view, {} share a cell\n",
                    job.input, job.output, count_text(counts.kept), count_text(counts.returns),
                    grid.height, grid.width, count_text(counts.out_of_range),
                    count_text(counts.out_of_fov), count_text(counts.collided))};
  });
}

}  // namespace

Command add_project(CLI::App& root) {
  CLI::App* app =
      root.add_subcommand("project", "Lay raw scans on a grid of directions (organised clouds)");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  options->project.min_range_m = 5;
  app->add_option("inputs", options->inputs, "Scans; - is standard input")->required();
  app->add_option("-o,--output", options->output,
                  "File, or directory for many inputs; default NAME.projected.pcd beside the "
                  "input, - is standard output");
  app->add_option(
         "--rows", options->rows,
         "uniform (one for each ring, evenly spaced over the nominal field of view), rings "
         "(at the true elevations) or a number of uniform rows")
      ->capture_default_str();
  app->add_option("--cols", options->project.columns, "Columns in a turn")
      ->capture_default_str()
      ->check(number_in(4, 65536));
  app->add_option("--min-range", options->project.min_range_m,
                  "Drop returns nearer than this, metres")
      ->capture_default_str()
      ->check(number_in(0.0, 1e6));
  app->add_option("--max-range", options->max_range,
                  "Drop returns farther than this: metres, p90 for the 90th percentile of range, "
                  "or max for the sensor's own limit")
      ->capture_default_str();
  app->add_option("--sensor", options->sensor, kSensorHelp)->capture_default_str();
  app->add_option("--format", options->format,
                  fmt::format("Format of the input: {}; default by content", kFormatNames));
  app->add_option("--to-format", options->to_format, "Format of the output; default by extension");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
