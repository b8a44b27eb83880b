// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar decode scan.curl                        the coded returns, one for one, in scan.decoded.pcd
  curlidar decode scan.curl --rows 8 -o dense.ply  8 times denser from top to bottom
  curlidar decode scan.curl --rows 1.5 --cols 0.5 -o other.npy
  curlidar decode out/*.curl -o back/ --format bin --attributes intensity
The format follows the extension of -o, or --format. KITTI .bin and nuScenes files hold fixed
attributes: choose them with --attributes.)";

struct Options {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string output, format, encoding = "binary", attributes = "all";
  double rows = 1, columns = 1;
  bool no_masks = false, organised = false;
};

/// "bin" is what people call KITTI's format.
std::optional<CloudFormat> parse_output_format(const std::string& name) {
  return parse_format(name == "bin" ? "kitti" : name);
}

std::string suffix_of(const std::optional<CloudFormat>& format) {
  if (!format) return ".decoded.pcd";
  switch (*format) {
    case CloudFormat::pcd:
      return ".decoded.pcd";
    case CloudFormat::ply:
      return ".decoded.ply";
    case CloudFormat::kitti:
      return ".decoded.bin";
    case CloudFormat::nuscenes:
      return ".decoded.pcd.bin";
    case CloudFormat::npy:
      return ".decoded.npy";
    case CloudFormat::csv:
      return ".decoded.csv";
  }
  return ".decoded.pcd";
}

int run(const Options& options) {
  ReconstructSettings settings;
  settings.rows = options.rows;
  settings.columns = options.columns;
  settings.masks = !options.no_masks;
  settings.organised = options.organised;
  settings.threads = options.common.threads;
  WriteOptions write_options;
  write_options.format = parse_output_format(options.format);
  write_options.encoding = parse_encoding(options.encoding);
  const auto attributes = parse_attribute_list(options.attributes);
  const auto jobs = plan_jobs(options.inputs, options.output, suffix_of(write_options.format));
  return for_each_job(options.common, jobs, [&](const Job& job, const ProgressCallback& progress) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const DecodedScan scan = load_curl(job.input);
    progress("reconstruct", 0.1);
    Cloud cloud = need(reconstruct(scan, settings));
    keep_attributes(cloud, attributes);
    const std::chrono::duration<double, std::milli> elapsed = Clock::now() - start;
    progress("write", 0.9);
    save_cloud(job.output, cloud, write_options, kAttributesHint);
    const std::size_t points = count_returns(cloud);
    return Outcome{{{"profile", to_string(scan.profile)},
                    {"sensor", scan.sensor.name},
                    {"rows", options.rows},
                    {"cols", options.columns},
                    {"points_coded", scan.coded_returns},
                    {"points", points},
                    {"decode_ms", elapsed.count()},
                    {"metadata", scan.metadata}},
                   fmt::format("{} -> {}  {} points ({} coded), {}\n", job.input, job.output,
                               count_text(points), count_text(scan.coded_returns),
                               milliseconds_text(elapsed.count()))};
  });
}

}  // namespace

Command add_decode(CLI::App& root) {
  CLI::App* app = root.add_subcommand("decode", "Get clouds of any density back from .curl files");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("inputs", options->inputs, ".curl files; - is standard input")->required();
  app->add_option("-o,--output", options->output,
                  "File, or directory for many inputs; default NAME.decoded.pcd beside the input, "
                  "- is standard output");
  const auto factor = number_in(1e-3, 65536.0);
  app->add_option("--rows", options->rows,
                  "R_row: factor on the coded grid's rows, may be fractional")
      ->capture_default_str()
      ->check(factor);
  app->add_option("--cols", options->columns, "R_col: the same for columns")
      ->capture_default_str()
      ->check(factor);
  app->add_flag("--no-masks", options->no_masks,
                "A point for every direction, also where no surface is to be believed");
  app->add_flag("--organised,--organized", options->organised,
                "Keep the grid: rows x columns points, NaN where there is none");
  app->add_option("--attributes", options->attributes,
                  "Attributes to write: all, none, or names such as intensity,ring")
      ->capture_default_str();
  app->add_option("--format", options->format,
                  fmt::format("Format of the output: {}; default by extension", kFormatNames));
  app->add_option("--encoding", options->encoding,
                  "ascii, binary, binary_compressed (PCD) or binary_big_endian (PLY)")
      ->capture_default_str();
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
