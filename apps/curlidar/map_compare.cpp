// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common_map_pictures.hpp"
#include "common_maps.hpp"
#include "map.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar map compare map.curl truth.ply
  curlidar map compare map.curl scans/*.bin --poses poses.txt --max-range 40 -o errors.png
  curlidar map compare map.curl other.curl --json
Accuracy: from points on the map's surface, every --spacing metres, to the nearest point of the
reference. Completeness: from every point of the reference to the map's continuous surface. Distances
are exact and in 3D; above --max-distance they count as that. What the reference has not seen counts
against the map, unless --crop leaves out what lies outside of the reference's bounding box.)";

struct Options {
  CommonOptions common;
  std::string map, output, show = "map", size = "1280x0";
  ReferenceOptions reference;
  MapCompareSettings settings;
  bool allow_truncated = false;
};

Json distances_json(const MapDistances& distances, const std::vector<double>& thresholds) {
  Json json{{"count", distances.count},  {"mean", distances.mean}, {"rms", distances.rms},
            {"p50", distances.p50},      {"p95", distances.p95},   {"max", distances.max},
            {"capped", distances.capped}};
  json["within"] = Json::array();
  for (std::size_t i = 0; i < thresholds.size(); ++i) {
    json["within"].push_back({{"threshold", thresholds[i]}, {"share", distances.within[i]}});
  }
  return json;
}

std::vector<std::string> distances_row(const char* name, const MapDistances& distances) {
  std::vector<std::string> row{name,
                               count_text(distances.count),
                               length_text(distances.mean),
                               length_text(distances.rms),
                               length_text(distances.p50),
                               length_text(distances.p95),
                               length_text(distances.max)};
  for (const double share : distances.within) row.push_back(fmt::format("{:.4f}", share));
  return row;
}

std::string table_of(const MapComparison& result, const std::vector<double>& thresholds) {
  Table table(0);
  std::vector<std::string> head{"", "points", "mean", "rms", "p50", "p95", "max"};
  std::vector<std::string> scores{"F-score", "", "", "", "", "", ""};
  for (std::size_t i = 0; i < thresholds.size(); ++i) {
    head.push_back("< " + length_text(thresholds[i]));
    scores.push_back(fmt::format("{:.4f}", result.f_scores[i]));
  }
  table.add(head);
  table.add(distances_row("accuracy: map to reference", result.accuracy));
  table.add(distances_row("completeness: reference to surface", result.completeness));
  table.add(distances_row("  the same to points of the map", result.completeness_points));
  table.add(scores);
  return table.text();
}

/// What a reader of the figures must know.
std::vector<std::string> notes_of(const Options& options, const MapComparison& result,
                                  const PointSubset& reference) {
  std::vector<std::string> notes;
  if (!options.settings.crop) {
    notes.push_back("map where the reference has no points counts against accuracy (see --crop)");
  }
  if (result.map_points > options.settings.max_points) {
    notes.push_back(fmt::format("accuracy is that of a random subset of {} points on the map",
                                count_text(result.map_points)));
  }
  if (!reference.complete()) {
    notes.push_back(
        fmt::format("the reference is a random subset of {} points: accuracy looks worse "
                    "than it is (--max-reference)",
                    count_text(reference.seen())));
  }
  return notes;
}

/// The map's points or the reference's, with attribute error.
Cloud error_cloud(const Options& options, MapComparison& result, Cloud reference) {
  if (options.show == "map") return std::move(result.samples);
  reference.attributes.insert(reference.attributes.begin(),
                              {"error", 1, std::move(result.reference_errors)});
  return reference;
}

void write_output(const Options& options, Cloud cloud) {
  if (!options.output.ends_with(".png")) {
    save_cloud(options.output, cloud, {});
    return;
  }
  RenderSettings settings;
  settings.view = View::birds_eye;
  settings.colour = ColourBy::error;
  settings.value_max = options.settings.thresholds.empty() ? options.settings.max_distance_m
                                                           : options.settings.thresholds.back();
  need(write_png(options.output, map_picture(std::move(cloud), settings, options.size)));
}

int run(const Options& options) {
  refuse_mixed_stdout(options.common, options.output);
  refuse_same_file(options.map, options.output);
  for (const std::string& file : options.reference.files) refuse_same_file(file, options.output);
  if (options.show != "map" && options.show != "reference") {
    usage_error(fmt::format("--show '{}': give map or reference", options.show));
  }
  ProgressBar bar(!options.common.quiet);
  const ProgressCallback progress = [&](std::string_view stage, double fraction) {
    bar.update(0, 1, stage, fraction);
  };
  MapTiles tiles = read_tiles(open_surface_map(options.map, options.allow_truncated));
  const PointSubset points =
      read_reference(options.reference, options.settings.spacing_m, progress, tiles.damaged);
  Cloud reference = points.cloud();
  Json json{{"map", options.map}, {"reference", options.reference.files}};
  json.update(tiles.json());
  const MapScene scene = need(MapScene::make(std::move(tiles.tiles)));
  MapCompareSettings settings = options.settings;
  settings.threads = options.common.threads;
  progress("compare", 0.5);
  MapComparison result = need(compare_map(scene, reference, settings));
  bar.clear();
  const std::vector<std::string> notes = notes_of(options, result, points);
  json["spacing"] = settings.spacing_m;
  json["max_distance"] = settings.max_distance_m;
  json["map_points"] = result.map_points;
  json["reference_points"] = points.seen();
  json["accuracy"] = distances_json(result.accuracy, settings.thresholds);
  json["completeness"] = distances_json(result.completeness, settings.thresholds);
  json["completeness_points"] = distances_json(result.completeness_points, settings.thresholds);
  json["f_scores"] = Json::array();
  for (std::size_t i = 0; i < result.f_scores.size(); ++i) {
    json["f_scores"].push_back(
        {{"threshold", settings.thresholds[i]}, {"f_score", result.f_scores[i]}});
  }
  json["notes"] = notes;
  std::string text = table_of(result, settings.thresholds);
  for (const std::string& note : notes) text += "note: " + note + '\n';
  if (!options.output.empty()) {
    write_output(options, error_cloud(options, result, std::move(reference)));
  }
  print_result(options.common, {std::move(json), std::move(text)}, options.output == "-");
  return tiles.exit_code();
}

}  // namespace

Command add_map_compare(CLI::App& map) {
  CLI::App* app = map.add_subcommand(
      "compare", "How far a map is from a reference: accuracy, completeness, F-score");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  MapCompareSettings& settings = options->settings;
  app->add_option("MAP", options->map, "A surface map")->required();
  app->add_option("REFERENCE", options->reference.files,
                  "Clouds or maps in the map's frame, or with --poses scans")
      ->required();
  add_reference_options(*app, options->reference);
  app->add_option("--spacing", settings.spacing_m,
                  "Between the points that stand for the map, metres")
      ->capture_default_str()
      ->check(number_in(1e-3, 10));
  app->add_option("--max-distance", settings.max_distance_m,
                  "Larger distances count as this one, metres")
      ->capture_default_str()
      ->check(number_in(1e-3, 100));
  app->add_option("--thresholds", settings.thresholds,
                  "Distances of shares and F-scores, metres (default 0.05,0.1,0.2)")
      ->delimiter(',')
      ->allow_extra_args(false)  // or it takes MAP for more of them
      ->check(number_in(0, 100));
  app->add_flag("--crop", settings.crop, "Leave out map outside of the reference's bounding box");
  app->add_option("--max-points", settings.max_points,
                  "Of more points on the map a random subset is taken")
      ->capture_default_str()
      ->check(number_in(1, 4e9));
  app->add_option("-o,--output", options->output,
                  "Points with their distance as attribute 'error', or a .png of them from above");
  app->add_option("--show", options->show, "For -o: points of the map, or of the reference")
      ->capture_default_str();
  app->add_option("--size", options->size, "Of the picture in pixels; height 0 = what suits")
      ->type_name("WxH")
      ->capture_default_str();
  app->add_flag("--allow-truncated", options->allow_truncated,
                "Take what is whole of a map cut off");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
