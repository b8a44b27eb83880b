// SPDX-License-Identifier: BSD-3-Clause
// Scans of a drive and the poses that belong to them.
#pragma once

#include <string>
#include <vector>

#include "common_options.hpp"
#include "curlidar/pose.hpp"

namespace curlidar::app {

/// The files of a drive in order: a directory stands for the clouds and .curl files in it, sorted
/// by name; .csv files only if there are no others. Failure(kExitFile) if one is missing or a
/// directory holds none.
std::vector<std::string> list_scans(const std::vector<std::string>& inputs);

/// --poses, --calib, --times, --pose-format.
struct PoseOptions {
  std::string path, calib, times, format;
};
void add_pose_options(CLI::App& app, PoseOptions& options);

/// The poses of `scans` scans, with warnings printed; none, but the times, without --poses. Failure
/// if there are not as many as scans.
PoseTrack load_poses(const PoseOptions& options, std::size_t scans);

}  // namespace curlidar::app
