// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar convert scan.bin scan.pcd
  curlidar convert scan.pcd scan.csv --attributes intensity --drop-invalid
  curlidar convert scans/*.bin plys/ --to-format ply
  curlidar convert - - --format kitti --to-format pcd <scan.bin >scan.pcd
  curlidar convert scan.curl scan.ply              decodes, one for one
Nothing is dropped silently: what the new format cannot hold is an error that names it.)";

struct Options {
  CommonOptions common;
  std::vector<std::string> paths;
  std::string format, to_format, encoding = "binary", attributes = "all";
  bool drop_invalid = false;
};

const char* suffix_of(CloudFormat format) {
  switch (format) {
    case CloudFormat::pcd:
      return ".pcd";
    case CloudFormat::ply:
      return ".ply";
    case CloudFormat::kitti:
      return ".bin";
    case CloudFormat::nuscenes:
      return ".pcd.bin";
    case CloudFormat::npy:
      return ".npy";
    case CloudFormat::csv:
      return ".csv";
  }
  return ".pcd";
}

Cloud without_invalid(const Cloud& cloud) {
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (is_return(cloud.positions[i])) kept.push_back(static_cast<std::uint32_t>(i));
  }
  return select(cloud, kept);
}

int run(const Options& options) {
  if (options.paths.size() < 2) usage_error("give the input and the output: convert IN OUT");
  const std::string& output = options.paths.back();
  const std::vector<std::string> inputs(options.paths.begin(), options.paths.end() - 1);
  if (output.ends_with(".curl")) usage_error("'curlidar encode' makes .curl files");
  WriteOptions write_options;
  write_options.format = parse_format(options.to_format);
  write_options.encoding = parse_encoding(options.encoding);
  const auto format = parse_format(options.format);
  const auto attributes = parse_attribute_list(options.attributes);
  const auto jobs =
      plan_jobs(inputs, output, suffix_of(write_options.format.value_or(CloudFormat::pcd)));
  return for_each_job(options.common, jobs, [&](const Job& job, const ProgressCallback&) {
    Cloud cloud = load_cloud(job.input, format);
    const std::size_t points_in = cloud.size();
    if (options.drop_invalid) cloud = without_invalid(cloud);
    keep_attributes(cloud, attributes);
    save_cloud(job.output, cloud, write_options, kAttributesHint);
    return Outcome{
        {{"points_in", points_in}, {"points", cloud.size()}},
        fmt::format("{} -> {}  {} points\n", job.input, job.output, count_text(cloud.size()))};
  });
}

}  // namespace

Command add_convert(CLI::App& root) {
  CLI::App* app = root.add_subcommand("convert", "Change the file format of clouds");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("paths", options->paths,
                  "IN OUT, or IN... DIRECTORY; - is standard input or output")
      ->required();
  app->add_option("--format", options->format,
                  fmt::format("Format of the input: {}; default by content", kFormatNames));
  app->add_option("--to-format", options->to_format,
                  "Format of the output; default by extension, PCD for - and directories");
  app->add_option("--encoding", options->encoding,
                  "ascii, binary, binary_compressed (PCD) or binary_big_endian (PLY)")
      ->capture_default_str();
  app->add_option("--attributes", options->attributes,
                  "Attributes to keep: all, none, or names such as intensity,ring")
      ->capture_default_str();
  app->add_flag("--drop-invalid", options->drop_invalid,
                "Drop slots without a return: NaN, infinite and (0, 0, 0)");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
