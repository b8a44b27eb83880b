// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "map.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kBuildFooter = R"(Examples:
  curlidar map build scans/ --poses poses.txt -o street.curl
  curlidar map build scans/ --poses poses.txt --quality fine --max-range 40 -o street.curl
  curlidar map build velodyne/ --poses 00.txt --calib calib.txt --times times.txt -o 00.curl
  curlidar map build scans/ --poses poses.txt --kind scans --every 5m -o keyframes.curl
A surface map holds the surface of the world, fused from all scans; a map of scans holds keyframes,
each a whole .curl scan with its pose, as the CURL paper has it.)";

constexpr const char* kAppendFooter = R"(Examples:
  curlidar map append street.curl more/ --poses more.txt
  curlidar map append street.curl more/ --poses more.txt -o longer.curl
Tiles that the new scans do not change are copied byte by byte.)";

struct BuildOptions {
  CommonOptions common;
  MapInputs inputs;
  std::string map, kind = "surface", quality = "small", sensor = "auto";
  MapHeader header;
  std::vector<double> origin;
  std::optional<double> error_m;
  std::uint32_t columns = 1024, effort = CompactSettings{}.effort;
  CLI::App* app = nullptr;
  CLI::Option *step = nullptr, *metres_per_bit = nullptr, *footprint = nullptr, *tile = nullptr;
};

/// Options that would do nothing for a map of this kind are a mistake.
void refuse_other_kind(const BuildOptions& options, MapKind kind) {
  const bool surface = kind == MapKind::surface;
  const std::vector<const char*> others =
      surface
          ? std::vector<const char*>{"--error", "--columns", "--effort", "--sensor"}
          : std::vector<const char*>{"--quality", "--metres-per-bit", "--footprint", "--tile-side",
                                     "--curves",  "--still",          "--memory"};
  for (const char* name : others) {
    const CLI::Option* option = options.app->get_option_no_throw(name);
    if (option == nullptr || option->count() == 0) continue;
    usage_error(fmt::format("{} is for {}, and this is a {}", name,
                            surface ? "maps of scans" : "surface maps",
                            surface ? "surface map" : "map of scans"));
  }
}

/// How the keyframes of a map of scans are coded. A step by default, not an error: what a mean
/// error costs depends on how well the sensor's rings are known, and it may be out of reach.
constexpr double kScanStep_m = 0.3;
EncodeSettings scan_settings(const BuildOptions& options) {
  if (options.error_m && options.step->count() > 0) {
    usage_error("--error and --step both say how exact the scans are: give one");
  }
  EncodeSettings scan;
  scan.compact.coverage = Coverage::image;
  scan.compact.columns = options.columns;
  scan.compact.effort = options.effort;
  scan.compact.target = options.error_m ? CompactTarget::error : CompactTarget::step;
  const double step_m = options.step->count() > 0 ? options.header.surface.step_m : kScanStep_m;
  scan.compact.target_value = options.error_m.value_or(step_m);
  scan.sensor = parse_sensor(options.sensor);
  scan.attributes = std::vector<std::string>{};
  if (options.header.surface.intensity) scan.attributes->push_back("intensity");
  return scan;
}

/// What a word for the quality stands for; options of their own go before.
SurfaceSettings surface_of(const BuildOptions& options) {
  SurfaceSettings surface;
  if (options.quality == "fine") {
    surface.metres_per_bit = 0.05;
    surface.footprint_m = 0.125;
  } else if (options.quality != "small") {
    usage_error(fmt::format("--quality {}: it is small or fine", options.quality));
  }
  const SurfaceSettings& given = options.header.surface;
  if (options.step->count() > 0) surface.step_m = given.step_m;
  if (options.metres_per_bit->count() > 0) surface.metres_per_bit = given.metres_per_bit;
  if (options.footprint->count() > 0) surface.footprint_m = given.footprint_m;
  surface.curves = given.curves;
  surface.intensity = given.intensity;
  return surface;
}

int run_build(const BuildOptions& options) {
  refuse_mixed_stdout(options.common, options.inputs.output);
  MapBuildSettings settings;
  settings.header = options.header;
  settings.header.surface = surface_of(options);
  if (options.kind == "scans") {
    settings.header.kind = MapKind::scans;
  } else if (options.kind != "surface") {
    usage_error(fmt::format("--kind {}: it is surface or scans", options.kind));
  }
  if (!options.origin.empty()) {
    settings.header.origin = {options.origin[0], options.origin[1], options.origin[2]};
    settings.origin_of_first_scan = false;
  }
  refuse_other_kind(options, settings.header.kind);
  settings.scan = scan_settings(options);
  settings.still = options.inputs.still;
  settings.threads = options.common.threads;
  apply(options.inputs, settings);
  MapBuilder builder = need_option(MapBuilder::create(settings));
  print_result(options.common,
               build_map(options.common, options.inputs, builder, options.inputs.output),
               options.inputs.output == "-");
  return kExitOk;
}

int run_append(const BuildOptions& options) {
  const std::string& output = options.inputs.output.empty() ? options.map : options.inputs.output;
  refuse_mixed_stdout(options.common, output);
  const auto map = std::make_shared<const MapFile>(load_map(options.map));
  MapBuildSettings settings;
  refuse_other_kind(options, map->header().kind);
  if (map->header().kind == MapKind::surface && options.step->count() > 0) {
    usage_error("--step is for maps of scans: a surface map keeps its own");
  }
  settings.scan = scan_settings(options);
  settings.still = options.inputs.still;
  settings.threads = options.common.threads;
  apply(options.inputs, settings);
  MapBuilder builder = need(MapBuilder::append(map, settings));
  const std::uint64_t before = map->file_bytes();
  Outcome outcome = build_map(options.common, options.inputs, builder, output);
  outcome.json["bytes_before"] = before;
  outcome.text += fmt::format("  {} before\n", bytes_text(before));
  print_result(options.common, outcome, output == "-");
  return kExitOk;
}

void add_scan_options(CLI::App& app, BuildOptions& options) {
  options.app = &app;
  options.step = app.add_option("--step", options.header.surface.step_m,
                                "Rounding of planes, m; of maps of scans the quantiser's step, "
                                "default 0.3");
  app.add_option("--error", options.error_m,
                 "Maps of scans: mean error of the returns instead of a step, m")
      ->check(number_in(0.001, 10));
  app.add_option("--columns", options.columns, "Maps of scans: columns of a turn")
      ->capture_default_str()
      ->check(number_in(16, 65536));
  app.add_option("--effort", options.effort, "Maps of scans: 1 (fast) to 9 (smallest)")
      ->capture_default_str()
      ->check(number_in(1, kMaxEffort));
  app.add_flag("--still", options.inputs.still,
               "Surface maps: leave out what moved, seen by some scans and looked through by more");
}

}  // namespace

Command add_map_build(CLI::App& map) {
  CLI::App* app = map.add_subcommand("build", "Make a map from scans with poses");
  app->footer(kBuildFooter);
  const auto options = std::make_shared<BuildOptions>();
  app->add_option("scans", options->inputs.inputs,
                  "Scans in order, folders of them, or sequences, which may bring their poses")
      ->required();
  app->add_option("-o,--output", options->inputs.output, "The map")->required();
  add_map_inputs(*app, options->inputs);
  app->add_option("--kind", options->kind, "surface or scans")->capture_default_str();
  app->add_option("--quality", options->quality, "Surface maps: small or fine")
      ->capture_default_str();
  MapHeader& header = options->header;
  app->add_option("--min-range", header.min_range_m, "Nearer returns are left out, m")
      ->capture_default_str();
  app->add_option("--max-range", header.max_range_m, "Farther returns are left out, m")
      ->capture_default_str();
  options->metres_per_bit = app->add_option("--metres-per-bit", header.surface.metres_per_bit,
                                            "What a bit must save: sum of distances, m");
  options->footprint = app->add_option("--footprint", header.surface.footprint_m,
                                       "Cells that tell where surface was seen, m");
  options->tile = app->add_option("--tile-side", header.tile_side_m, "Side of a tile, m")
                      ->capture_default_str();
  app->add_flag("--curves", header.surface.curves, "Surface may be of second order");
  app->add_flag("--intensity", header.surface.intensity, "Keep the intensity");
  app->add_option("--origin", options->origin,
                  "Origin of the tiles, m; default the first scan's place in whole metres")
      ->delimiter(',')
      ->expected(3);
  app->add_option("--sensor", options->sensor, std::string("Maps of scans: ") + kSensorHelp);
  add_scan_options(*app, *options);
  add_common_options(*app, options->common);
  return {app, [options] { return run_build(*options); }};
}

Command add_map_append(CLI::App& map) {
  CLI::App* app = map.add_subcommand("append", "Make a map longer by more scans");
  app->footer(kAppendFooter);
  const auto options = std::make_shared<BuildOptions>();
  app->add_option("map", options->map, "The map, replaced when all is done")->required();
  app->add_option("scans", options->inputs.inputs, "Scans in order, or folders of them")
      ->required();
  app->add_option("-o,--output", options->inputs.output, "Another file for the longer map");
  add_map_inputs(*app, options->inputs);
  add_scan_options(*app, *options);
  add_common_options(*app, options->common);
  return {app, [options] { return run_append(*options); }};
}

}  // namespace curlidar::app
