// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common_maps.hpp"
#include "curlidar/pose.hpp"
#include "map.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar map sample map.curl --sensor vlp16 --pose 12,3,1.7,0,0,90 -o scan.pcd
  curlidar map sample map.curl --sensor hdl64e-kitti --poses poses.txt --index 7 -o scan.ply
  curlidar map sample map.curl --along scan.bin --poses poses.txt -o again.pcd
The scan is in the sensor's frame: rings from the top, columns from behind over the right to the
front and on; NaN where the map has nothing within the sensor's reach. Angles of --pose: roll about
x, then pitch about y (positive looks down), then yaw about z (positive to the left). Only the
tiles within reach are read.)";

struct Options {
  CommonOptions common;
  std::string map, output, sensor, along, pose, poses, calib;
  std::size_t index = 0;
  std::optional<double> max_range_m;
  bool allow_truncated = false, one_origin = false;
  MapSceneSettings scene;
  SampleMapSettings sample;
};

RigidMotion pose_of(const Options& options) {
  if (!options.pose.empty()) return parse_pose(options.pose);
  const PoseTrack track = need(read_poses(options.poses, {{}, options.calib, {}}));
  for (const std::string& warning : track.warnings) print_warning(warning);
  if (options.index < track.T_map_sensor.size()) return track.T_map_sensor[options.index];
  throw Failure({ErrorCode::invalid_argument,
                 fmt::format("{}: there is no pose {}, counted from 0, among {}", options.poses,
                             options.index, track.T_map_sensor.size())},
                kExitInput);
}

/// How far returns of a scan are from what the map has along their lines of sight.
struct RangeErrors {
  std::size_t returns = 0, met = 0;
  double p50 = 0, p90 = 0, p95 = 0;
};

RangeErrors range_errors(const Cloud& scan, const Cloud& found, double max_range_m) {
  RangeErrors errors;
  std::vector<double> differences;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!is_return(scan.positions[i]) || norm(scan.positions[i]) > max_range_m) continue;
    ++errors.returns;
    if (!is_return(found.positions[i])) continue;
    differences.push_back(std::abs(norm(found.positions[i]) - norm(scan.positions[i])));
  }
  errors.met = differences.size();
  if (differences.empty()) return errors;
  errors.p50 = percentile(differences, 0.5);
  errors.p90 = percentile(differences, 0.9);
  errors.p95 = percentile(differences, 0.95);
  return errors;
}

void check(const Options& options) {
  refuse_mixed_stdout(options.common, options.output);
  refuse_same_file(options.map, options.output);
  if (options.sensor.empty() == options.along.empty()) {
    usage_error("give either --sensor or --along");
  }
  if (options.pose.empty() == options.poses.empty()) usage_error("give either --pose or --poses");
  if (!options.along.empty()) refuse_same_file(options.along, options.output);
}

std::string errors_text(const RangeErrors& errors) {
  return fmt::format(
      "  along {} returns: {} meet the map ({:.1f} %); ranges differ by {} (median), "
      "{} (p90), {} (p95)\n",
      count_text(errors.returns), count_text(errors.met),
      100.0 * static_cast<double>(errors.met) /
          static_cast<double>(std::max<std::size_t>(errors.returns, 1)),
      length_text(errors.p50), length_text(errors.p90), length_text(errors.p95));
}

int run(const Options& options) {
  constexpr double kDefaultReach_m = 120;
  check(options);
  std::optional<SensorProfile> sensor;
  if (!options.sensor.empty()) sensor = need_option(load_sensor(options.sensor));
  if (sensor && options.max_range_m) sensor->max_range_m = *options.max_range_m;
  const double reach = sensor ? sensor->max_range_m : options.max_range_m.value_or(kDefaultReach_m);
  const RigidMotion pose = pose_of(options);
  const MapFile map = open_surface_map(options.map, options.allow_truncated);
  // Beams may start some decimetres beside the sensor's origin.
  const Vec3 around = Vec3{1, 1, 1} * (reach + 1);
  MapTiles tiles = read_tiles(map, MapBox{pose.move - around, pose.move + around});
  Json json{{"map", options.map}, {"output", options.output}};
  json.update(tiles.json());
  const MapScene scene = need(MapScene::make(std::move(tiles.tiles), options.scene));
  SampleMapSettings settings = options.sample;
  settings.threads = options.common.threads;
  settings.beam_origins = !options.one_origin;
  std::string details;
  Cloud cloud;
  if (sensor) {
    cloud = need(sample_map(scene, *sensor, pose, settings));
  } else {
    const Cloud scan = load_cloud(options.along, std::nullopt);
    cloud = need(sample_map_along(scene, scan, pose, reach, settings));
    const RangeErrors errors = range_errors(scan, cloud, reach);
    details = errors_text(errors);
    json["along"] = {
        {"returns", errors.returns},
        {"met", errors.met},
        {"range_error", {{"p50", errors.p50}, {"p90", errors.p90}, {"p95", errors.p95}}}};
  }
  save_cloud(options.output, cloud, {});
  const std::size_t returns = count_returns(cloud);
  if (returns == 0) print_warning("no line of sight met the map: see 'map info' for its extent");
  json["rows"] = cloud.height;
  json["columns"] = cloud.width;
  json["returns"] = returns;
  json["leaves"] = scene.leaves();
  print_result(
      options.common,
      {std::move(json),
       fmt::format("{} -> {}  {} of {} lines of sight met the map, {} of {} tiles read\n{}",
                   options.map, options.output, count_text(returns), count_text(cloud.size()),
                   tiles.read, tiles.of, details)},
      options.output == "-");
  return tiles.exit_code();
}

}  // namespace

Command add_map_sample(CLI::App& map) {
  CLI::App* app = map.add_subcommand("sample", "A scan of a map: what a sensor would see there");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("MAP", options->map, "A surface map")->required();
  app->add_option("-o,--output", options->output, "Cloud file; - is standard output")->required();
  app->add_option("--sensor", options->sensor,
                  "A built-in name (see 'curlidar sensors'), or a .toml or Ouster .json file");
  app->add_option("--along", options->along,
                  "Instead: the lines of sight of this scan's returns, from its origin; the report "
                  "tells how far its ranges are from the map's");
  app->add_option("--pose", options->pose, "Place of the sensor, metres and degrees")
      ->type_name("X,Y,Z[,ROLL,PITCH,YAW]");
  CLI::Option* poses =
      app->add_option("--poses", options->poses, "File of poses (see docs/poses.md)");
  app->add_option("--calib", options->calib, "KITTI's calib.txt: the poses are those of the camera")
      ->needs(poses);
  app->add_option("--index", options->index, "Which of the poses, counted from 0")
      ->needs(poses)
      ->capture_default_str();
  app->add_option("--max-range", options->max_range_m,
                  "Reach, metres; default the sensor's, 120 with --along")
      ->check(number_in(0.1, 1e4));
  app->add_flag("--normals", options->sample.normals,
                "Attributes normal_x, normal_y, normal_z in the sensor's frame");
  app->add_flag("--one-origin", options->one_origin,
                "All beams leave from the sensor's origin, not where its profile says");
  app->add_option("--gap", options->scene.gap_cells,
                  "A line that meets nothing meets surface this far beside its footprint, in cells")
      ->capture_default_str()
      ->check(number_in(0, 1));
  app->add_flag("--allow-truncated", options->allow_truncated,
                "Take what is whole of a map cut off");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
