// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "common_paper.hpp"
#include "curlidar/paper.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar mesh scan.pcd                      scan.mesh.ply
  curlidar mesh scan.bin --min-range 1 --max-range max -o street.ply
The mesh is the polar Delaunay triangulation of the gridded scan with its convex closure: a closed
surface around the sensor. Cliffs are not cut out of it.)";

struct Options {
  CommonOptions common;
  PaperOptions paper;
  std::vector<std::string> inputs;
  std::string output, format;
  bool ascii = false;
};

int run(const Options& options) {
  options.paper.check();
  const auto format = parse_format(options.format);
  const std::vector<Job> jobs = plan_jobs(options.inputs, options.output, ".mesh.ply");
  return for_each_job(options.common, jobs, [&](const Job& job, const ProgressCallback&) {
    const Cloud cloud = load_cloud(job.input, format);
    const Mesh mesh =
        need(polar_mesh(cloud, options.paper.settings(cloud, options.common.threads)));
    need(write_mesh(job.output, mesh.vertices, mesh.triangles,
                    options.ascii ? Encoding::ascii : Encoding::binary));
    return Outcome{
        {{"vertices", mesh.vertices.size()}, {"triangles", mesh.triangles.size()}},
        fmt::format("{} -> {}  {} vertices, {} triangles\n", job.input, job.output,
                    count_text(mesh.vertices.size()), count_text(mesh.triangles.size()))};
  });
}

}  // namespace

Command add_mesh(CLI::App& root) {
  CLI::App* app = root.add_subcommand("mesh", "Polar mesh of scans as PLY (the paper's stage A)");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("inputs", options->inputs, "Scans; - is standard input")->required();
  app->add_option("-o,--output", options->output,
                  "PLY file, or directory for many inputs; default NAME.mesh.ply beside the input, "
                  "- is standard output");
  app->add_option("--format", options->format,
                  fmt::format("Format of the input: {}; default by content", kFormatNames));
  app->add_flag("--ascii", options->ascii, "Text instead of binary PLY");
  options->paper.add_grid(*app);
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
