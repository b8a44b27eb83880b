// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tuple>
#include <utility>

#include "commands.hpp"
#include "common_inputs.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar decode scan.curl                        the scan as it was, in scan.decoded.pcd
  curlidar decode scan.curl --rows 8 -o dense.ply  8 times denser from top to bottom
  curlidar decode scan.curl --rows 1.5 --cols 0.5 -o other.npy
  curlidar decode out/*.curl -o back/ --format bin --attributes intensity
  curlidar decode scan.curl --rings 16:48 --azimuth -45:45 -o ahead.pcd
  curlidar decode cut.curl --allow-truncated       as far as the file goes
The format follows the extension of -o, or --format. KITTI .bin and nuScenes files hold fixed
attributes: choose them with --attributes. Depth images give the coded returns, one for one.)";

struct Options {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string output, format, encoding = "binary", attributes = "all", rings, azimuth, region;
  double rows = 1, columns = 1;
  bool no_masks = false, organised = false, field_only = false, allow_truncated = false;
};

/// "A:B" as two numbers.
template <class T>
std::pair<T, T> parse_interval(const std::string& text, const char* option, const char* example) {
  const std::size_t colon = text.find(':');
  std::pair<T, T> ends;
  const bool good =
      colon != std::string::npos && CLI::detail::lexical_cast(text.substr(0, colon), ends.first) &&
      CLI::detail::lexical_cast(text.substr(colon + 1), ends.second) && ends.first < ends.second;
  if (!good) {
    usage_error(fmt::format("{} '{}': give BEGIN:END, the smaller number first, such as {}", option,
                            text, example));
  }
  return ends;
}

/// What --region, or --rings and --azimuth, say as texts; empty = all.
std::pair<std::string, std::string> region_texts(const Options& options) {
  if (options.region.empty()) return {options.rings, options.azimuth};
  if (!options.rings.empty() || !options.azimuth.empty()) {
    usage_error("--region holds both rings and azimuths: leave --rings and --azimuth out");
  }
  const std::size_t comma = options.region.find(',');
  if (comma == std::string::npos) {
    usage_error(
        fmt::format("--region '{}': give RINGS,AZIMUTHS, such as 16:48,-45:45", options.region));
  }
  return {options.region.substr(0, comma), options.region.substr(comma + 1)};
}

DecodeOptions decode_options(const Options& options) {
  DecodeOptions decoding;
  decoding.field_only = options.field_only;
  decoding.allow_truncated = options.allow_truncated;
  decoding.threads = options.common.threads;
  const auto [rings, azimuth] = region_texts(options);
  const bool together = !options.region.empty();
  ScanRegion region;
  if (together || !rings.empty()) {
    std::tie(region.ring_begin, region.ring_end) =
        parse_interval<std::uint32_t>(rings, together ? "--region" : "--rings", "0:16");
  }
  if (together || !azimuth.empty()) {
    const auto [begin, end] =
        parse_interval<double>(azimuth, together ? "--region" : "--azimuth", "-45:45");
    if (!(begin >= -360 && end <= 720)) {
      usage_error(fmt::format("azimuths '{}': degrees, from -360 to 720", azimuth));
    }
    region.azimuth_begin = begin * std::numbers::pi / 180;
    region.azimuth_end = end * std::numbers::pi / 180;
  }
  if (!rings.empty() || !azimuth.empty()) decoding.region = region;
  return decoding;
}

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

/// Says what helps if a file is refused only because its end is missing.
DecodedScan load(const Job& job, DecodeOptions decoding) {
  try {
    return load_curl(job.input, decoding);
  } catch (const Failure& failure) {
    if (decoding.allow_truncated || failure.code() != kExitInput || job.input == "-") throw;
    decoding.allow_truncated = true;
    if (!decode(need(read_file(job.input)), decoding)) throw;
    throw Failure({ErrorCode::corrupt,
                   fmt::format("{}; --allow-truncated decodes what is there", failure.what())},
                  kExitInput);
  }
}

/// One line, however much is missing.
std::string missing_text(const std::string& input, const std::vector<std::string>& missing) {
  constexpr std::size_t kNamed = 3;
  std::string text = fmt::format("{} is cut off and lacks {}", input, missing.front());
  for (std::size_t i = 1; i < std::min(missing.size(), kNamed); ++i) text += "; " + missing[i];
  if (missing.size() > kNamed) {
    text += fmt::format("; and {} more parts, see --json", missing.size() - kNamed);
  }
  return text;
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
  const DecodeOptions decoding = decode_options(options);
  const auto jobs = plan_jobs(options.inputs, options.output, suffix_of(write_options.format));
  return for_each_job(options.common, jobs, [&](const Job& job, const ProgressCallback& progress) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const DecodedScan scan = load(job, decoding);
    if (!scan.missing.empty()) print_warning(missing_text(job.input, scan.missing));
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
                    {"missing", scan.missing},
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
  app->add_option("--rings", options->rings,
                  "Only rings BEGIN .. END-1, 0 the highest (compact files)")
      ->type_name("BEGIN:END");
  app->add_option("--azimuth", options->azimuth,
                  "Only azimuths from BEGIN counter-clockwise to END, degrees, 0 ahead (compact "
                  "files)")
      ->type_name("BEGIN:END");
  app->add_option("--region", options->region, "Both at once, such as 16:48,-45:45")
      ->type_name("RINGS,AZIMUTHS");
  app->add_flag("--field-only", options->field_only,
                "Leave residuals and corrections out (compact files)");
  app->add_flag("--allow-truncated", options->allow_truncated,
                "Take files that are cut off as far as they go, with a warning of what is missing");
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
