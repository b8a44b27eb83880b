// SPDX-License-Identifier: BSD-3-Clause
// simulate --drive: scans of a moving sensor, with poses and the exact surface.
#pragma once

#include <string>

#include "common_options.hpp"
#include "curlidar/drive.hpp"

namespace curlidar::app {

struct DriveOptions {
  bool drive = false, truth = false, no_traffic = false, moving = false;
  std::string to_format;  ///< of the scans; empty: KITTI's, which hold intensity alone
  DriveSettings settings;
};

void add_drive_options(CLI::App& app, DriveOptions& options);

/// Writes scans, poses.txt, times.txt and, if wanted, truth.ply into a folder.
int run_drive(const CommonOptions& common, const DriveOptions& options,
              const SimulateSettings& simulate, const SensorProfile& sensor,
              const std::string& folder);

}  // namespace curlidar::app
