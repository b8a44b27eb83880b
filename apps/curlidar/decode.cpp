// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "decode_plan.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar decode scan.curl                        the scan as it was, in scan.decoded.pcd
  curlidar decode scan.curl --rows 8 -o dense.ply  8 times denser from top to bottom
  curlidar decode scan.curl --rows 1.5 --cols 0.5 -o other.npy
  curlidar decode scan.curl --density 400 -o even.ply    a point every 5 cm on every surface
  curlidar decode scan.curl --sensor os1-128 -o os1.pcd  as an OS-1-128 would have seen it
  curlidar decode scan.curl --directions rays.npy -o hits.npy
  curlidar decode scan.curl --rows 4 --mesh -o surface.obj
  curlidar decode vlp16.curl --preset sparse --confidence -o dense.pcd
  curlidar decode out/*.curl -o back/ --format bin --attributes intensity
  curlidar decode scan.curl --rings 16:48 --azimuth -45:45 -o ahead.pcd
  curlidar decode cut.curl --allow-truncated       as far as the file goes
The format follows the extension of -o, or --format. KITTI .bin and nuScenes files hold fixed
attributes: choose them with --attributes. Depth images give the coded returns, one for one.)";

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

/// A result without a single point is right, but seldom what was meant.
void warn_if_empty(const Job& job, const DecodedScan& scan, const DecodePlan& plan,
                   std::size_t points) {
  const bool in_part = plan.decoding().region.has_value();
  if (points != 0 || (scan.coded_returns == 0 && !in_part)) return;
  print_warning(
      scan.coded_returns == 0
          ? fmt::format("{} holds no return in this region: {} is empty", job.input, job.output)
          : fmt::format("nothing of {} is believed where it was asked for: {} is empty", job.input,
                        job.output));
}

/// KITTI's readers take every record for a point.
void warn_of_empty_slots(const Job& job, const Cloud& cloud, const DecodePlan& plan,
                         std::size_t points) {
  const auto format =
      plan.writing().format ? plan.writing().format : cloud_format_by_extension(job.output);
  const bool fixed = format == CloudFormat::kitti || format == CloudFormat::nuscenes;
  if (!fixed || !plan.keeps_empty() || points == cloud.size()) return;
  print_warning(
      fmt::format("{}: {} records are NaN, for which {} files have no agreed meaning; npy, "
                  "pcd and ply keep it",
                  job.output, count_text(cloud.size() - points), to_string(*format)));
}

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Json report_json(const DecodedScan& scan, const ReconstructSettings& settings, std::size_t points,
                 double ms) {
  return {{"profile", to_string(scan.profile)},
          {"sensor", scan.sensor.name},
          {"rows", settings.rows},
          {"cols", settings.columns},
          {"min_confidence", settings.min_confidence},
          {"points_coded", scan.coded_returns},
          {"points", points},
          {"decode_ms", ms},
          {"missing", scan.missing},
          {"metadata", scan.metadata}};
}

Outcome write_mesh_of(const Job& job, const DecodedScan& scan, const DecodePlan& plan,
                      Clock::time_point start, const ProgressCallback& progress) {
  const ReconstructSettings settings = plan.settings(scan);
  const SurfaceMesh mesh = need(reconstruct_mesh(scan, settings, progress));
  const double ms = milliseconds_since(start);
  warn_if_empty(job, scan, plan, mesh.vertices.size());
  need(write_mesh(job.output, mesh.vertices, mesh.triangles, plan.writing().encoding, mesh.normals,
                  plan.mesh_format()));
  Json json = report_json(scan, settings, mesh.vertices.size(), ms);
  json["triangles"] = mesh.triangles.size();
  return {json, fmt::format("{} -> {}  {} vertices, {} triangles, {}\n", job.input, job.output,
                            count_text(mesh.vertices.size()), count_text(mesh.triangles.size()),
                            milliseconds_text(ms))};
}

Outcome write_cloud_of(const Job& job, const DecodedScan& scan, const DecodePlan& plan,
                       Clock::time_point start, const ProgressCallback& progress) {
  const ReconstructSettings settings = plan.settings(scan);
  const Cloud cloud = plan.cloud(scan, settings, progress);
  const double ms = milliseconds_since(start);
  const std::size_t points = count_returns(cloud);
  warn_if_empty(job, scan, plan, points);
  warn_of_empty_slots(job, cloud, plan, points);
  save_cloud(job.output, cloud, plan.writing(), kAttributesHint);
  return {report_json(scan, settings, points, ms),
          fmt::format("{} -> {}  {} points ({} coded), {}\n", job.input, job.output,
                      count_text(points), count_text(scan.coded_returns), milliseconds_text(ms))};
}

int run(const DecodeCommand& command) {
  const DecodePlan plan(command);
  const auto jobs = plan_jobs(command.inputs, command.output, plan.suffix());
  return for_each_job(command.common, jobs, [&](const Job& job, const ProgressCallback& progress) {
    const auto start = Clock::now();
    const DecodedScan scan = load(job, plan.decoding());
    if (!scan.missing.empty()) print_warning(missing_text(job.input, scan.missing));
    const auto second_half = [&](std::string_view stage, double fraction) {
      progress(stage, 0.1 + 0.8 * fraction);
    };
    return plan.mesh() ? write_mesh_of(job, scan, plan, start, second_half)
                       : write_cloud_of(job, scan, plan, start, second_half);
  });
}

}  // namespace

Command add_decode(CLI::App& root) {
  CLI::App* app = root.add_subcommand("decode", "Get clouds of any density back from .curl files");
  app->footer(kFooter);
  const auto command = std::make_shared<DecodeCommand>();
  add_decode_options(*app, *command);
  return {app, [command] { return run(*command); }};
}

}  // namespace curlidar::app
