// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "common_paper.hpp"
#include "curlidar/paper.hpp"
#include "curlidar/render.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar upsample vlp16.pcd --rows 4 --cols 1       16 rings to 64 rows
  curlidar upsample scan.bin --dump-masks masks/      point grid and cliffs as PNG, too
Upsampled directions are cast into the polar mesh of the scan; hits on the largest triangles and
between cliffs are refused, original returns are kept.)";

struct Options {
  CommonOptions common;
  PaperOptions paper;
  std::vector<std::string> inputs;
  std::string output, format, to_format, mask_directory;
  std::uint32_t rows = 2, columns = 2;
};

/// White where the mask is set, one pixel for each cell.
Status write_mask(const std::string& path, const Upsampled& scan,
                  const std::vector<std::uint8_t>& mask) {
  Image image;
  image.width = scan.mask_columns;
  image.height = scan.mask_rows;
  image.rgb.reserve(mask.size() * 3);
  for (const std::uint8_t set : mask) image.rgb.insert(image.rgb.end(), 3, set != 0 ? 255 : 0);
  return write_png(path, image);
}

void write_masks(const std::string& directory, const std::string& name, const Upsampled& scan) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);  // a failure shows in the first write
  const std::string start = (std::filesystem::path(directory) / name).string();
  need(write_mask(start + ".points.png", scan, scan.point_grid));
  need(write_mask(start + ".cliff-row.png", scan, scan.cliff_row));
  need(write_mask(start + ".cliff-column.png", scan, scan.cliff_column));
  need(write_mask(start + ".cliff-diagonal.png", scan, scan.cliff_diagonal));
}

int run(const Options& options) {
  options.paper.check();
  const auto format = parse_format(options.format);
  WriteOptions write_options;
  write_options.format = parse_format(options.to_format);
  const std::vector<Job> jobs = plan_jobs(options.inputs, options.output, ".upsampled.pcd");
  return for_each_job(options.common, jobs, [&](const Job& job, const ProgressCallback&) {
    const Cloud cloud = load_cloud(job.input, format);
    EncodeSettings settings = options.paper.settings(cloud, options.common.threads);
    settings.paper.upsample_rows = options.rows;
    settings.paper.upsample_columns = options.columns;
    const Upsampled scan = need(upsample_scan(cloud, settings));
    if (!options.mask_directory.empty()) {
      write_masks(options.mask_directory, stem_of(job.input), scan);
    }
    save_cloud(job.output, scan.cloud, write_options);
    const std::size_t points = count_returns(scan.cloud);
    return Outcome{
        {{"points_in", scan.projection.returns},
         {"points_gridded", scan.projection.kept},
         {"points", points},
         {"rows", scan.rows},
         {"columns", scan.columns}},
        fmt::format("{} -> {}  {} returns, {} gridded, {} after upsampling to {} x {}\n", job.input,
                    job.output, count_text(scan.projection.returns),
                    count_text(scan.projection.kept), count_text(points), scan.rows, scan.columns)};
  });
}

}  // namespace

Command add_upsample(CLI::App& root) {
  CLI::App* app = root.add_subcommand(
      "upsample", "Make scans denser by virtual LiDAR (the paper's stages A and B)");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("inputs", options->inputs, "Scans; - is standard input")->required();
  app->add_option("-o,--output", options->output,
                  "File, or directory for many inputs; default NAME.upsampled.pcd beside the "
                  "input, - is standard output");
  app->add_option("--rows", options->rows, "S_row: factor on the grid's rows")
      ->capture_default_str()
      ->check(number_in(1, 64));
  app->add_option("--cols", options->columns, "S_col: factor on the grid's columns")
      ->capture_default_str()
      ->check(number_in(1, 64));
  app->add_option("--dump-masks", options->mask_directory,
                  "Directory for the point grid and the cliffs as PNG");
  app->add_option("--format", options->format,
                  fmt::format("Format of the input: {}; default by content", kFormatNames));
  app->add_option("--to-format", options->to_format, "Format of the output; default by extension");
  options->paper.add_grid(*app, "grid-");
  options->paper.add_cliffs(*app);
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
