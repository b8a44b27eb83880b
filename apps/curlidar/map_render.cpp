// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "common_map_pictures.hpp"
#include "common_maps.hpp"
#include "common_pictures.hpp"
#include "map.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar map render map.curl                               map.png, from above, by height
  curlidar map render map.curl --view perspective --colour normal -o map.png --size 1920x1080
  curlidar map render map.curl --colour error --reference truth.ply --max-value 0.2
From above the map's x is up and its y to the left. The middle of the picture, and of the circles,
is that of the map.)";

struct Options {
  CommonOptions common;
  std::string map, output, view = "top", colour = "height", size = "1280x0";
  RenderSettings render;
  ReferenceOptions reference;
  double spacing_m = 0.1;
  std::size_t max_points = 4'000'000;
  bool allow_truncated = false;
};

RenderSettings settings_of(const Options& options) {
  RenderSettings settings = options.render;
  settings.colour = need_option(colour_by_name(options.colour));
  if (options.view == "top") {
    settings.view = View::birds_eye;
  } else if (options.view == "perspective") {
    settings.view = View::perspective;
  } else {
    usage_error(fmt::format("--view '{}': give top or perspective", options.view));
  }
  if (settings.colour == ColourBy::range) {
    usage_error(
        "--colour range: a map is not seen from a sensor; give height, intensity, normal "
        "or error");
  }
  if ((settings.colour == ColourBy::error) != !options.reference.files.empty()) {
    usage_error("--colour error and --reference FILE go together");
  }
  return settings;
}

/// Points of the map with their distances from the reference.
Cloud with_errors(const Options& options, MapTiles& tiles, const ProgressCallback& progress) {
  MapCompareSettings settings;
  settings.spacing_m = options.spacing_m;
  settings.max_points = options.max_points;
  settings.threads = options.common.threads;
  const PointSubset reference =
      read_reference(options.reference, options.spacing_m, progress, tiles.damaged);
  const MapScene scene = need(MapScene::make(std::move(tiles.tiles)));
  return need(compare_map(scene, reference.cloud(), settings)).samples;
}

int run(const Options& options) {
  const RenderSettings settings = settings_of(options);
  std::string output = options.output;
  if (output.empty()) output = plan_jobs({options.map}, "", ".png").front().output;
  refuse_mixed_stdout(options.common, output);
  refuse_same_file(options.map, output);
  for (const std::string& file : options.reference.files) refuse_same_file(file, output);
  ProgressBar bar(!options.common.quiet);
  const ProgressCallback progress = [&](std::string_view stage, double fraction) {
    bar.update(0, 1, stage, fraction);
  };
  MapTiles tiles = read_tiles(open_surface_map(options.map, options.allow_truncated));
  Json json{{"map", options.map}, {"output", output}};
  Cloud cloud;
  if (settings.colour == ColourBy::error) {
    cloud = with_errors(options, tiles, progress);
  } else {
    cloud = need(map_points(tiles.tiles, options.spacing_m, options.max_points))
                .cloud(settings.colour == ColourBy::normal);
  }
  json.update(tiles.json());
  const std::size_t points = cloud.size();
  progress("draw", 0.8);
  const Image image = map_picture(std::move(cloud), settings, options.size);
  need(write_png(output, image));
  bar.clear();
  json.update({{"points", points}, {"width", image.width}, {"height", image.height}});
  print_result(
      options.common,
      {std::move(json), fmt::format("{} -> {}  {} points, {} x {} pixels\n", options.map, output,
                                    count_text(points), image.width, image.height)},
      output == "-");
  return tiles.exit_code();
}

void add_view_options(CLI::App& app, Options& options) {
  app.add_option("--view", options.view, "top or perspective")->capture_default_str();
  app.add_option("--colour,--color", options.colour, "height, intensity, normal or error")
      ->capture_default_str();
  add_picture_options(app, options.render, options.size, "the map's middle", "the map's origin");
}

}  // namespace

Command add_map_render(CLI::App& map) {
  CLI::App* app = map.add_subcommand("render", "Draw a map as a PNG picture");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("MAP", options->map, "A surface map")->required();
  app->add_option("-o,--output", options->output,
                  "PNG file; default NAME.png beside the map, - is standard output");
  add_view_options(*app, *options);
  app->add_option("--spacing", options->spacing_m, "Between the points that are drawn, metres")
      ->capture_default_str()
      ->check(number_in(1e-3, 10));
  app->add_option("--max-points", options->max_points, "Of more points a random subset is drawn")
      ->capture_default_str()
      ->check(number_in(1, 4e9));
  app->add_option("--reference", options->reference.files,
                  "For --colour error: clouds or maps in the map's frame, or with --poses scans");
  add_reference_options(*app, options->reference);
  app->add_flag("--allow-truncated", options->allow_truncated,
                "Take what is whole of a map cut off");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
