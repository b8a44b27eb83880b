// SPDX-License-Identifier: BSD-3-Clause
// Scans and poses of `map build` and `map append`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "map.hpp"

namespace curlidar::app {
namespace {

namespace fs = std::filesystem;

/// Files as they are given, folders as the clouds and .curl files in them, by name.
std::vector<std::string> scan_files(const std::vector<std::string>& inputs) {
  std::vector<std::string> files;
  for (const std::string& input : inputs) {
    std::error_code error;
    if (!fs::is_directory(input, error)) {
      files.push_back(input);
      continue;
    }
    std::vector<std::string> found;
    for (fs::directory_iterator at(input, error), end; !error && at != end; at.increment(error)) {
      const std::string path = at->path().string();
      const bool scan = cloud_format_by_extension(path) || path.ends_with(".curl");
      // Text beside scans is times and poses.
      if (scan && !path.ends_with(".txt") && !at->path().filename().string().starts_with('.')) {
        found.push_back(path);
      }
    }
    if (error || found.empty()) {
      throw Failure({ErrorCode::not_found,
                     fmt::format("{}: {}", input, error ? error.message() : "no scans in it")},
                    kExitFile);
    }
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

PoseTrack poses_for(const MapInputs& inputs, std::size_t scans) {
  PoseReadOptions options;
  if (!inputs.pose_format.empty()) {
    options.format = need_option(pose_format_by_name(inputs.pose_format));
  }
  options.calib_path = inputs.calib;
  options.times_path = inputs.times;
  PoseTrack track = need(read_poses(inputs.poses, options));
  for (const std::string& warning : track.warnings) print_warning(warning);
  if (track.T_map_sensor.size() != scans) {
    throw Failure({ErrorCode::invalid_argument,
                   fmt::format("{}: {} poses for {} scans; give one pose for each scan, in their "
                               "order",
                               inputs.poses, track.T_map_sensor.size(), scans)},
                  kExitInput);
  }
  return track;
}

std::string report_text(const MapReport& report, const std::string& output, double travelled_m,
                        double seconds) {
  std::string text =
      fmt::format("{}: {}, {} of {} scans, {} points", output, bytes_text(report.bytes),
                  report.taken, report.offered, count_text(report.points));
  if (travelled_m > 0) {
    text += fmt::format(", {:.0f} bytes a metre of {:.1f} m",
                        static_cast<double>(report.bytes) / travelled_m, travelled_m);
  }
  text += fmt::format("; {:.1f} s\n", seconds);
  if (report.tiles_kept > 0) {
    text += fmt::format("  {} of {} parts kept as they were\n", report.tiles_kept, report.tiles);
  }
  return text;
}

}  // namespace

void add_map_inputs(CLI::App& app, MapInputs& inputs) {
  app.add_option("--poses", inputs.poses,
                 "Poses, one for each scan: T_map_sensor, in KITTI, TUM, matrix or CSV form")
      ->required();
  app.add_option("--calib", inputs.calib, "KITTI's calib.txt: the poses are those of its camera");
  app.add_option("--times", inputs.times, "Times of the scans, seconds, one on each line");
  app.add_option("--pose-format", inputs.pose_format,
                 "kitti, tum, matrix or csv; default by content");
  app.add_option("--format", inputs.format,
                 fmt::format("Format of the scans: {}; default by content", kFormatNames));
  app.add_option("--every", inputs.every,
                 "Take every n-th scan (5), or one every few metres (5m); default all");
  app.add_option("--memory", inputs.max_memory_mb,
                 "Megabytes of samples held at once; others wait in a temporary file")
      ->capture_default_str()
      ->check(number_in(1, 1e6));
}

void apply(const MapInputs& inputs, MapBuildSettings& settings) {
  const std::string& text = inputs.every;
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string unit(end, text.data() + text.size());
  const bool metres = unit == "m";
  if (error != std::errc() || !(metres || unit.empty()) || !(number > 0 && number <= 1e9) ||
      (!metres && number != std::floor(number))) {
    usage_error(fmt::format("--every {}: a number of scans (5) or of metres (5m) is needed", text));
  }
  settings.every_m = metres ? number : 0;
  settings.every_scans = metres ? 1 : static_cast<std::uint32_t>(number);
  constexpr double kBytesASample = 100;
  settings.max_samples = static_cast<std::size_t>(inputs.max_memory_mb * 1e6 / kBytesASample);
}

Outcome build_map(const CommonOptions& common, const MapInputs& inputs, MapBuilder& builder,
                  const std::string& output) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::string> scans = scan_files(inputs.inputs);
  const PoseTrack track = poses_for(inputs, scans.size());
  const auto format = parse_format(inputs.format);
  ProgressBar bar(!common.quiet);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    bar.update(0, 1, fmt::format("scan {} of {}", i + 1, scans.size()),
               0.8 * static_cast<double>(i) / static_cast<double>(scans.size()));
    const RigidMotion& pose = track.T_map_sensor[i];
    if (!builder.takes(pose)) {
      builder.skip(pose);
      continue;
    }
    const Cloud cloud = load_cloud(scans[i], format);
    std::optional<double> time_s;
    if (!track.time_s.empty()) time_s = track.time_s[i];
    const auto added = builder.add_scan(cloud, pose, time_s);
    if (!added) {
      throw Failure({added.error().code, fmt::format("{}: {}", scans[i], added.error().message)},
                    exit_code_of(added.error().code));
    }
  }
  const MapReport report =
      need(builder.finish(output, [&](std::string_view stage, double fraction) {
        bar.update(0, 1, stage, 0.8 + 0.2 * fraction);
      }));
  bar.clear();
  for (const std::string& note : report.notes) print_warning(note);
  double travelled_m = 0;
  for (std::size_t i = 1; i < track.T_map_sensor.size(); ++i) {
    travelled_m += norm(track.T_map_sensor[i].move - track.T_map_sensor[i - 1].move);
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return {{{"output", output},
           {"bytes", report.bytes},
           {"scans", report.offered},
           {"scans_taken", report.taken},
           {"points", report.points},
           {"samples", report.samples},
           {"samples_explained", report.explained},
           {"samples_moved", report.moved},
           {"most_samples_held", report.most_samples},
           {"parts", report.tiles},
           {"parts_kept", report.tiles_kept},
           {"travelled_m", travelled_m},
           {"seconds", seconds.count()},
           {"notes", report.notes}},
          report_text(report, output, travelled_m, seconds.count())};
}

}  // namespace curlidar::app
