// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/render.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "common_pictures.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/reconstruct.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar render scan.pcd                                   scan.png, perspective by height
  curlidar render scan.bin --view range-image --colour range -o image.png
  curlidar render scan.curl --rows 8 --view birds-eye --extent 30
  curlidar render scan.curl --colour error --reference scan.pcd --max-value 0.2
  curlidar render scan.curl --view partition -o blocks.png   what the compact codec made of it
  curlidar render scan.curl --view degrees -o degrees.png    patches of the paper's profiles
  curlidar render scans/*.bin -o pictures/ --size 640x480)";

struct Options {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string output, format, view = "perspective", colour = "height", reference, size = "1280x0";
  RenderSettings render;
  ReconstructSettings reconstruct;
  std::optional<std::size_t> scan;
};

void parse_size(const std::string& text, RenderSettings& settings) {
  const std::size_t cross = text.find('x');
  const std::string height = cross == std::string::npos ? "0" : text.substr(cross + 1);
  const bool good = CLI::detail::lexical_cast(text.substr(0, cross), settings.width) &&
                    CLI::detail::lexical_cast(height, settings.height) && settings.width > 0 &&
                    settings.width <= 16384 && settings.height <= 16384;
  if (!good) {
    usage_error(
        fmt::format("--size '{}': give WIDTHxHEIGHT in pixels up to 16384, height 0 for "
                    "what suits the view",
                    text));
  }
}

bool shows_partition(const RenderSettings& settings) {
  return settings.view == View::partition || settings.view == View::layers ||
         settings.view == View::degrees;
}

RenderSettings render_settings(const Options& options) {
  RenderSettings settings = options.render;
  settings.view = need_option(view_by_name(options.view));
  settings.colour = need_option(colour_by_name(options.colour));
  parse_size(options.size, settings);
  if ((settings.colour == ColourBy::error) != !options.reference.empty()) {
    usage_error("--colour error and --reference CLOUD go together");
  }
  if (shows_partition(settings)) {
    // Cells are what these views show, coloured by range.
    if (settings.colour == ColourBy::error) {
      usage_error(fmt::format("--view {} does not show errors", options.view));
    }
    settings.colour = ColourBy::range;
  }
  return settings;
}

/// Blocks of a compact file for the views partition and layers, patches of one of the paper's
/// profiles for the view degrees.
std::vector<PartitionBlock> blocks_of(const DecodedScan& scan, View view) {
  std::vector<PartitionBlock> blocks;
  if (view == View::degrees && !scan.paper_patches.empty()) {
    for (const PaperPatch& patch : scan.paper_patches) {
      blocks.push_back({patch.row, patch.column, patch.rows, patch.columns, patch.degree});
    }
  } else if (view != View::degrees && scan.compact) {
    for (const CompactLeaf& leaf : scan.compact->leaves) {
      blocks.push_back({leaf.row, leaf.column, leaf.rows, leaf.columns, leaf.layers});
    }
  } else {
    throw Failure(
        {ErrorCode::invalid_argument,
         fmt::format("--view partition and layers show files of the compact profile, degrees those "
                     "of the profiles paper and paper-1to1; this one is of profile {}",
                     to_string(scan.profile))},
        kExitInput);
  }
  return blocks;
}

/// The picture of a file's blocks.
Image partition_picture(const std::string& path, const RenderSettings& settings,
                        std::size_t threads, const std::optional<std::size_t>& scan_chosen,
                        std::size_t& points) {
  DecodeOptions decoding;
  decoding.partition = true;
  decoding.threads = threads;
  const DecodedScan scan = load_curl(path, decoding, scan_chosen);
  const std::vector<PartitionBlock> blocks = blocks_of(scan, settings.view);
  ReconstructSettings plain;
  plain.organised = true;
  const Cloud cloud = need(reconstruct(scan, plain));
  points = scan.coded_returns;
  const std::vector<std::uint8_t> none;
  return need(render_partition(cloud, blocks, scan.compact ? scan.compact->layer : none, settings));
}

int run(const Options& options) {
  const RenderSettings settings = render_settings(options);
  const auto format = parse_format(options.format);
  check_scan_choice(options.scan, options.inputs);
  const std::vector<Job> jobs = plan_jobs(options.inputs, options.output, ".png");
  Cloud reference;
  if (!options.reference.empty()) {
    for (const Job& job : jobs) refuse_same_file(options.reference, job.output);
    reference = load_cloud(options.reference, std::nullopt, {}, options.scan);
  }
  ReconstructSettings reconstruct_settings = options.reconstruct;
  reconstruct_settings.threads = options.common.threads;
  return for_each_job(options.common, jobs, [&](const Job& job, const ProgressCallback& progress) {
    Image image;
    std::size_t points = 0;
    if (shows_partition(settings)) {
      image = partition_picture(job.input, settings, options.common.threads, options.scan, points);
    } else {
      const Cloud cloud = load_cloud(job.input, format, reconstruct_settings, options.scan);
      progress("draw", 0.5);
      std::vector<double> values;
      if (settings.colour == ColourBy::error) {
        values = need(nearest_distances(cloud, reference, options.common.threads));
      }
      image = need(render(cloud, settings, values));
      points = count_returns(cloud);
    }
    need(write_png(job.output, image));
    return Outcome{{{"points", points}, {"width", image.width}, {"height", image.height}},
                   fmt::format("{} -> {}  {} points, {} x {} pixels\n", job.input, job.output,
                               count_text(points), image.width, image.height)};
  });
}

void add_view_options(CLI::App& app, Options& options) {
  app.add_option(
         "--view", options.view,
         "range-image, birds-eye, perspective, of a compact .curl file partition or layers, of "
         "a file of the paper's profiles degrees")
      ->capture_default_str();
  app.add_option("--colour,--color", options.colour, "range, height, intensity, normal or error")
      ->capture_default_str();
  app.add_option("--reference", options.reference,
                 "For --colour error: cloud or .curl file to which distances are measured");
  add_picture_options(app, options.render, options.size, "the sensor", "the sensor");
}

}  // namespace

Command add_render(CLI::App& root) {
  CLI::App* app = root.add_subcommand("render", "Draw clouds and .curl files as PNG pictures");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("inputs", options->inputs, "Clouds or .curl files; - is standard input")
      ->required();
  app->add_option("-o,--output", options->output,
                  "File, or directory for many inputs; default NAME.png beside the input, - is "
                  "standard output");
  add_view_options(*app, *options);
  app->add_option("--scan", options->scan, kScanHelp)->type_name("K");
  const auto factor = number_in(1e-3, 65536.0);
  app->add_option("--rows", options->reconstruct.rows, "R_row with which .curl files are decoded")
      ->capture_default_str()
      ->check(factor);
  app->add_option("--cols", options->reconstruct.columns, "R_col for the same")
      ->capture_default_str()
      ->check(factor);
  app->add_option("--format", options->format,
                  fmt::format("Format of the input: {}; default by content", kFormatNames));
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
