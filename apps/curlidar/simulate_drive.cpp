// SPDX-License-Identifier: BSD-3-Clause
#include "simulate_drive.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "curlidar/pose.hpp"

namespace curlidar::app {
namespace {

constexpr double kTruthVoxel = 0.05;        // one exact point for each cube of this edge, metres
constexpr std::uint32_t kTruthColumns = 2;  // every second column is asked

/// Keeps the first point of every cube.
class Thinned {
 public:
  void add(const Cloud& points) {
    for (const Vec3& p : points.positions) {
      if (cubes_.insert(cube_of(p)).second) cloud_.positions.push_back(p);
    }
  }
  Cloud take() {
    cloud_.width = static_cast<std::uint32_t>(cloud_.size());
    cloud_.metadata["source"] = "simulated, exact, what does not move";
    return std::move(cloud_);
  }

 private:
  static std::uint64_t cube_of(const Vec3& p) {
    const auto index = [](double v) {
      return static_cast<std::uint64_t>(std::llround(std::floor(v / kTruthVoxel)) + (1 << 20));
    };
    return (index(p.x) << 42) | (index(p.y) << 21) | index(p.z);
  }

  std::unordered_set<std::uint64_t> cubes_;
  Cloud cloud_;
};

void make_folders(const std::filesystem::path& scans) {
  std::error_code error;
  std::filesystem::create_directories(scans, error);
  if (error) {
    throw Failure({ErrorCode::io, fmt::format("{}: cannot make this directory: {}", scans.string(),
                                              error.message())},
                  kExitFile);
  }
}

/// The name's end by which a scan of a drive tells its format.
const char* scan_suffix(CloudFormat format) {
  switch (format) {
    case CloudFormat::kitti:
      return ".bin";
    case CloudFormat::nuscenes:
      return ".pcd.bin";
    case CloudFormat::ply:
      return ".ply";
    case CloudFormat::npy:
      return ".npy";
    case CloudFormat::csv:
      return ".csv";
    case CloudFormat::pcd:
      break;
  }
  return ".pcd";
}

/// KITTI's and nuScenes' files have columns for some attributes only.
void fit_columns(Cloud& cloud, CloudFormat format) {
  if (format == CloudFormat::kitti) keep_attributes(cloud, {{"intensity"}});
  if (format == CloudFormat::nuscenes) keep_attributes(cloud, {{"intensity", "ring"}});
}

Json drive_json(const Drive& drive, const DriveOptions& options, const SensorProfile& sensor,
                const std::string& folder) {
  return {{"output", folder},
          {"sensor", sensor.name},
          {"seed", options.settings.seed},
          {"scans", drive.scans()},
          {"lap_m", drive.lap_m()}};
}

}  // namespace

void add_drive_options(CLI::App& app, DriveOptions& options) {
  const char* group = "A drive";
  app.add_flag(
         "--drive", options.drive,
         "Many scans of a car that drives around a block of houses: -o is a directory, which "
         "gets scans/*.bin (or of --to-format), poses.txt (rows of T_map_sensor) and times.txt")
      ->group(group);
  app.add_option("--scans", options.settings.scans, "Scans")
      ->capture_default_str()
      ->check(number_in(1, 1e6))
      ->group(group);
  app.add_option(
         "--laps", options.settings.laps,
         "Laps of the block (some 360 m each), the scans spread evenly; 0: as far as --step goes")
      ->capture_default_str()
      ->check(number_in(0.0, 1e6))
      ->group(group);
  app.add_option("--step", options.settings.step_m, "Metres between scans, without --laps")
      ->capture_default_str()
      ->check(number_in(1e-3, 1e3))
      ->group(group);
  app.add_flag("--still", options.settings.still, "The sensor stands, others move")->group(group);
  app.add_flag("--no-traffic", options.no_traffic, "Nothing else moves")->group(group);
  app.add_flag(
         "--moving", options.moving,
         "Add the attribute moving to the scans: 1 where a point lies on something that moves "
         "(--to-format pcd, ply, npy or csv)")
      ->group(group);
  app.add_flag("--truth", options.truth,
               "Also truth.ply: the exact surface that the scans have seen, without what moves, a "
               "point every 5 cm")
      ->group(group);
}

int run_drive(const CommonOptions& common, const DriveOptions& options,
              const SimulateSettings& simulate, const SensorProfile& sensor,
              const std::string& folder) {
  if (folder == "-") usage_error("--drive makes a directory: name it with -o");
  const CloudFormat format = parse_format(options.to_format).value_or(CloudFormat::kitti);
  if (options.moving && (format == CloudFormat::kitti || format == CloudFormat::nuscenes)) {
    usage_error("--moving: the format of the scans has no place for it; add --to-format pcd");
  }
  DriveSettings settings = options.settings;
  settings.traffic = !options.no_traffic;
  settings.seed = simulate.seed;
  const Drive drive = need_option(Drive::make(settings));
  SimulateSettings shot = simulate;
  shot.beam_origins = true;
  shot.mark_moving = options.moving;
  SensorProfile sparser = sensor;
  sparser.columns = std::max<std::uint32_t>(sensor.columns / kTruthColumns, 1);

  const std::filesystem::path root(folder);
  make_folders(root / "scans");
  WriteOptions write_options;
  write_options.format = format;
  PoseTrack track;
  Thinned truth;
  std::size_t points = 0;
  ProgressBar bar(!common.quiet);
  for (std::size_t i = 0; i < drive.scans(); ++i) {
    bar.update(i, drive.scans(), "simulate", 0);
    Cloud cloud = need(drive.scan(i, sensor, shot));
    fit_columns(cloud, format);
    points += cloud.size();
    const std::string name = fmt::format("{:06}{}", i, scan_suffix(format));
    save_cloud((root / "scans" / name).string(), cloud, write_options);
    track.T_map_sensor.push_back(drive.T_map_sensor(i));
    track.time_s.push_back(drive.time_s(i));
    if (options.truth) truth.add(need(drive.truth(i, sparser, shot)));
  }
  bar.clear();
  need(write_poses((root / "poses.txt").string(), track));
  need(write_times((root / "times.txt").string(), track.time_s));
  Json json = drive_json(drive, options, sensor, folder);
  json["points"] = points;
  std::string text = fmt::format("{}: {} scans, {} points, seen by {}\n", folder, drive.scans(),
                                 count_text(points), sensor.name);
  if (options.truth) {
    const Cloud exact = truth.take();
    const std::string name = (root / "truth.ply").string();
    save_cloud(name, exact, {});
    json["truth_output"] = name;
    json["truth_points"] = exact.size();
    text += fmt::format("{}: {} exact points\n", name, count_text(exact.size()));
  }
  print_result(common, {json, text});
  return kExitOk;
}

}  // namespace curlidar::app
