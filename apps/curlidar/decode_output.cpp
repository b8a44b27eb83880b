// SPDX-License-Identifier: BSD-3-Clause
#include "decode_output.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>

namespace curlidar::app {
namespace {

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

double milliseconds_since(DecodeClock::time_point start) {
  return std::chrono::duration<double, std::milli>(DecodeClock::now() - start).count();
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
                      DecodeClock::time_point start, const ProgressCallback& progress) {
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
                       DecodeClock::time_point start, const ProgressCallback& progress) {
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

}  // namespace

Outcome write_decoded(const Job& job, const DecodedScan& scan, const DecodePlan& plan,
                      DecodeClock::time_point start, const ProgressCallback& progress) {
  const auto second_half = [&](std::string_view stage, double fraction) {
    progress(stage, 0.1 + 0.8 * fraction);
  };
  return plan.mesh() ? write_mesh_of(job, scan, plan, start, second_half)
                     : write_cloud_of(job, scan, plan, start, second_half);
}

}  // namespace curlidar::app
