// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/compare.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "curlidar/metrics.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar compare scan.pcd scan.curl
  curlidar compare raw.bin decoded.ply --json
  curlidar compare raw.pcd scan.curl --error-cloud error.ply
  curlidar compare raw.pcd decoded.pcd --planes --thresholds 0.01,0.05 --quantiles 101 --json
  curlidar compare truth.pcd dense.pcd --images --min-range 2 --max-range 80
A is the reference, B what was made of it. Each return is measured to its nearest neighbour in the
other cloud, exactly (k-d tree). Read both directions: points that are missing show only from the
complete cloud, points that are invented only from the other. A .curl file counts as its plain
decode. docs/cli.md defines every figure.)";

struct Options {
  CommonOptions common;
  std::string a, b, format, error_cloud;
  std::optional<std::size_t> scan;
  MetricsSettings metrics;
  bool images = false;
  ImageSettings image_ranges;
};

Json stats_json(const DistanceStats& stats) {
  return {{"count", stats.count}, {"mean", stats.mean}, {"rms", stats.rms}, {"std", stats.std},
          {"p50", stats.p50},     {"p95", stats.p95},   {"max", stats.max}};
}

std::vector<std::string> stats_row(const char* name, std::size_t points,
                                   const DistanceStats& stats) {
  return {name,
          count_text(points),
          length_text(stats.mean),
          length_text(stats.rms),
          length_text(stats.std),
          length_text(stats.p50),
          length_text(stats.p95),
          length_text(stats.max)};
}

Json error_json(const GeometryError& error) {
  return {{"a_to_b_mse", error.a_to_b_mse},
          {"b_to_a_mse", error.b_to_a_mse},
          {"mse", error.mse},
          {"rms", error.rms},
          {"psnr_db", error.psnr}};
}

Json images_json(const ImageMetrics& images) {
  return {{"pixels", images.pixels},
          {"valid_a", images.valid_a},
          {"valid_b", images.valid_b},
          {"valid_both", images.valid_both},
          {"missed", images.missed},
          {"invented", images.invented},
          {"mask_iou", images.mask_iou},
          {"mae_all", images.mae_all},
          {"mae_both", images.mae_both},
          {"rmse_both", images.rmse_both},
          {"chamfer_m2_all", images.chamfer_squared_all}};
}

Json quantiles_json(const Metrics& metrics) {
  const std::size_t count = metrics.quantiles_a_to_b.size();
  std::vector<double> fractions;
  for (std::size_t i = 0; i < count; ++i) {
    fractions.push_back(static_cast<double>(i) / static_cast<double>(count - 1));
  }
  return {{"fractions", fractions},
          {"a_to_b", metrics.quantiles_a_to_b},
          {"b_to_a", metrics.quantiles_b_to_a}};
}

/// JSON has no infinity: a null that is one is told in words.
std::vector<std::string> notes_of(const Metrics& metrics,
                                  const std::optional<ImageMetrics>& images) {
  std::vector<std::string> notes;
  if (metrics.point_to_point.mse == 0) {
    notes.push_back("point_to_point.psnr_db is infinite: there is no error");
  }
  if (metrics.point_to_plane && metrics.point_to_plane->mse == 0) {
    notes.push_back("point_to_plane.psnr_db is infinite: there is no error");
  }
  if (images && images->valid_both == 0) {
    notes.push_back("images.mae_both and images.rmse_both are of no pixel");
  }
  if (images && images->valid_a + images->valid_b == 0) {
    notes.push_back("images.mask_iou is of no pixel");
  }
  return notes;
}

void add_metrics(Json& json, const Options& options, const Metrics& metrics,
                 const std::optional<ImageMetrics>& images) {
  json["symmetric"] = {{"mean", metrics.symmetric_mean}, {"rms", metrics.symmetric_rms}};
  json["chamfer_m"] = metrics.chamfer;
  json["chamfer_m2"] = metrics.chamfer_squared;
  json["matches"] = Json::array();
  for (const Match& match : metrics.matches) {
    json["matches"].push_back({{"threshold", match.threshold},
                               {"precision", match.precision},
                               {"recall", match.recall},
                               {"f_score", match.f_score}});
  }
  json["peak"] = options.metrics.peak;
  json["point_to_point"] = error_json(metrics.point_to_point);
  json["point_to_plane"] = nullptr;
  if (metrics.point_to_plane) {
    json["point_to_plane"] = error_json(*metrics.point_to_plane);
    json["point_to_plane"]["normals"] = metrics.normals_given ? "given" : "estimated";
  }
  const VoxelOverlap& voxels = metrics.voxels;
  json["voxels"] = {{"voxel", voxels.voxel},
                    {"occupied_a", voxels.occupied_a},
                    {"occupied_b", voxels.occupied_b},
                    {"occupied_both", voxels.occupied_both},
                    {"iou", voxels.iou},
                    {"precision", voxels.precision},
                    {"recall", voxels.recall},
                    {"f1", voxels.f1}};
  json["images"] = images ? images_json(*images) : Json(nullptr);
  json["quantiles"] = metrics.quantiles_a_to_b.empty() ? Json(nullptr) : quantiles_json(metrics);
  json["notes"] = notes_of(metrics, images);
}

std::string error_text(const GeometryError& error, double peak) {
  if (error.mse == 0) return "no error";
  return fmt::format("{:.2f} dB at a peak of {} m, rms {}", error.psnr, peak,
                     length_text(error.rms));
}

std::string metrics_text(const Options& options, const Metrics& metrics,
                         const std::optional<ImageMetrics>& images) {
  std::vector<std::pair<std::string, std::string>> lines{
      {"symmetric", fmt::format("mean {}, rms {}", length_text(metrics.symmetric_mean),
                                length_text(metrics.symmetric_rms))},
      {"Chamfer", fmt::format("{} (mean of means), {:.4g} m2 (sum of mean squares)",
                              length_text(metrics.chamfer), metrics.chamfer_squared)},
      {"D1, point to point", error_text(metrics.point_to_point, options.metrics.peak)}};
  if (metrics.point_to_plane) {
    lines.emplace_back("D2, point to plane",
                       error_text(*metrics.point_to_plane, options.metrics.peak));
  }
  for (const Match& match : metrics.matches) {
    lines.emplace_back("within " + length_text(match.threshold),
                       fmt::format("F-score {:.4f}, precision {:.4f}, recall {:.4f}", match.f_score,
                                   match.precision, match.recall));
  }
  lines.emplace_back("voxels of " + length_text(metrics.voxels.voxel),
                     fmt::format("IoU {:.4f}, F1 {:.4f}", metrics.voxels.iou, metrics.voxels.f1));
  if (images) {
    lines.emplace_back("images",
                       fmt::format("MAE {} of all pixels, {} of those valid in both (rms {})",
                                   length_text(images->mae_all), length_text(images->mae_both),
                                   length_text(images->rmse_both)));
    lines.emplace_back(
        "", fmt::format("mask IoU {:.4f}, {} pixels missed, {} invented", images->mask_iou,
                        count_text(images->missed), count_text(images->invented)));
  }
  return lines_text(lines);
}

void write_error_cloud(const Options& options, Cloud cloud, const Cloud& reference) {
  const std::vector<double> distances =
      need(nearest_distances(cloud, reference, options.common.threads));
  std::vector<float> values;
  values.reserve(distances.size());
  for (const double distance : distances) values.push_back(static_cast<float>(distance));
  std::erase_if(cloud.attributes, [](const Attribute& a) { return a.name == "error"; });
  cloud.attributes.push_back({"error", 1, std::move(values)});
  save_cloud(options.error_cloud, cloud, {});
}

int run(const Options& options) {
  refuse_mixed_stdout(options.common, options.error_cloud);
  if (options.a == "-" && options.b == "-") usage_error("only one of the clouds can be '-'");
  refuse_same_file(options.a, options.error_cloud);
  refuse_same_file(options.b, options.error_cloud);
  if (options.image_ranges.max_range <= options.image_ranges.min_range) {
    usage_error("--max-range must be above --min-range");
  }
  const auto format = parse_format(options.format);
  check_scan_choice(options.scan, {options.a, options.b});
  Cloud a = load_cloud(options.a, format, {}, options.scan);
  const Cloud b = load_cloud(options.b, format, {}, options.scan);
  const Metrics metrics = need(measure(a, b, options.metrics, options.common.threads));
  std::optional<ImageMetrics> images;
  if (options.images)
    images = need(compare_images(a, b, options.image_ranges, options.common.threads));
  if (!options.error_cloud.empty()) write_error_cloud(options, std::move(a), b);

  const Comparison& result = metrics.directed;
  Table table(0);
  table.add({"", "points", "mean", "rms", "std", "p50", "p95", "max"});
  table.add(stats_row("a to b", result.points_a, result.a_to_b));
  table.add(stats_row("b to a", result.points_b, result.b_to_a));
  Json json{{"a", options.a},
            {"b", options.b},
            {"points_a", result.points_a},
            {"points_b", result.points_b},
            {"a_to_b", stats_json(result.a_to_b)},
            {"b_to_a", stats_json(result.b_to_a)}};
  add_metrics(json, options, metrics, images);
  print_result(options.common,
               {std::move(json), fmt::format("a = {}\nb = {}\n{}{}", options.a, options.b,
                                             table.text(), metrics_text(options, metrics, images))},
               options.error_cloud == "-");
  return kExitOk;
}

void add_metrics_options(CLI::App& app, Options& options) {
  constexpr double kLargest = 1e6;
  MetricsSettings& metrics = options.metrics;
  app.add_option("--thresholds", metrics.thresholds,
                 "Distances of precision, recall and F-score, metres (default 0.02,0.05,0.1,0.2)")
      ->delimiter(',')
      ->allow_extra_args(false)  // or it takes A and B for more of them
      ->check(number_in(0, kLargest));
  app.add_option("--peak", metrics.peak, "Peak of the PSNR, metres (default 59.70)")
      ->check(number_in(1e-6, kLargest));
  app.add_flag("--planes", metrics.planes, "Measure point to plane (D2), too; takes longer");
  app.add_option("--voxel", metrics.voxel, "Edge of the voxels of IoU and F1, metres (default 0.1)")
      ->check(number_in(1e-6, kLargest));
  app.add_option("--quantiles", metrics.quantiles,
                 "So many quantiles of the distances each way, into the JSON report")
      ->check(number_in(2, 1e6));
  CLI::Option* images = app.add_flag("--images", options.images,
                                     "Compare organised clouds of one shape pixel by pixel");
  app.add_option("--min-range", options.image_ranges.min_range,
                 "With --images: nearer pixels count as empty, metres")
      ->needs(images)
      ->check(number_in(0, kLargest));
  app.add_option("--max-range", options.image_ranges.max_range,
                 "With --images: farther pixels count as empty, metres")
      ->needs(images)
      ->check(number_in(0, kLargest));
}

}  // namespace

Command add_compare(CLI::App& root) {
  CLI::App* app = root.add_subcommand(
      "compare", "How far two clouds are apart: distances both ways, PSNR, F-score");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("A", options->a, "The reference: cloud or .curl file; - is standard input")
      ->required();
  app->add_option("B", options->b, "Cloud or .curl file")->required();
  app->add_option("--format", options->format,
                  fmt::format("Format of both: {}; default by content", kFormatNames));
  app->add_option("--error-cloud", options->error_cloud,
                  "Write A with the distance of each point as attribute 'error', metres");
  add_metrics_options(*app, *options);
  app->add_option("--scan", options->scan, kScanHelp)->type_name("K");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
