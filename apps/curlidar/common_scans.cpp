// SPDX-License-Identifier: BSD-3-Clause
#include "common_scans.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <utility>

namespace curlidar::app {
namespace fs = std::filesystem;
namespace {

bool is_hidden(const fs::path& path) {
  return path.filename().string().front() == '.';
}

/// Files with points. Of text a scan may be, too, but text beside other scans is times and poses.
std::vector<std::string> names_in(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> names, tables;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::path& path = at->path();
    if (is_hidden(path) || at->is_directory() || path.extension() == ".txt") continue;
    if (path.extension() == ".csv") {
      tables.push_back(path.string());
    } else if (path.extension() == ".curl" || cloud_format_by_extension(path.string())) {
      names.push_back(path.string());
    }
  }
  if (error) {
    throw Failure(
        {ErrorCode::io, fmt::format("{}: cannot list this directory: {}", folder, error.message())},
        kExitFile);
  }
  return names.empty() ? tables : names;
}

void list_directory(const std::string& folder, std::vector<std::string>& out) {
  std::vector<std::string> names = names_in(folder);
  if (names.empty()) {
    throw Failure({ErrorCode::not_found, folder + ": no scan in this directory"}, kExitFile);
  }
  std::sort(names.begin(), names.end());
  out.insert(out.end(), names.begin(), names.end());
}

}  // namespace

std::vector<std::string> list_scans(const std::vector<std::string>& inputs) {
  std::vector<std::string> scans;
  for (const std::string& input : inputs) {
    std::error_code error;
    if (fs::is_directory(input, error)) {
      list_directory(input, scans);
    } else {
      scans.push_back(input);
    }
  }
  return scans;
}

void add_pose_options(CLI::App& app, PoseOptions& options) {
  const char* group = "Poses";
  app.add_option("--poses", options.path,
                 "Poses T_map_sensor of the scans: KITTI, TUM, matrices or CSV (docs/poses.md)")
      ->group(group);
  app.add_option("--calib", options.calib,
                 "KITTI's calib.txt: the poses are the camera's and become the sensor's")
      ->group(group);
  app.add_option("--times", options.times, "KITTI's times.txt: a time in seconds for each pose")
      ->group(group);
  app.add_option("--pose-format", options.format, "kitti, tum, matrix or csv; default by content")
      ->group(group);
}

PoseTrack load_poses(const PoseOptions& options, std::size_t scans) {
  PoseTrack track;
  if (options.path.empty()) {
    if (!options.calib.empty()) usage_error("--calib belongs to --poses");
    if (!options.format.empty()) usage_error("--pose-format belongs to --poses");
    if (options.times.empty()) return track;
    track.time_s = need(read_times(options.times));
    if (track.time_s.size() == scans) return track;
    throw Failure({ErrorCode::corrupt, fmt::format("{}: {} times for {} scans; there must be one "
                                                   "for each",
                                                   options.times, track.time_s.size(), scans)},
                  kExitInput);
  }
  PoseReadOptions read;
  if (!options.format.empty()) read.format = need_option(pose_format_by_name(options.format));
  read.calib_path = options.calib;
  read.times_path = options.times;
  track = need(read_poses(options.path, read));
  for (const std::string& warning : track.warnings) print_warning(warning);
  if (track.T_map_sensor.size() != scans) {
    throw Failure({ErrorCode::corrupt,
                   fmt::format("{}: {} poses for {} scans; there must be one for each, in the "
                               "order of the scans",
                               options.path, track.T_map_sensor.size(), scans)},
                  kExitInput);
  }
  return track;
}

}  // namespace curlidar::app
