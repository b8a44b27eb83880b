// SPDX-License-Identifier: BSD-3-Clause
// The options of `curlidar decode`: which part of a file, which points of it, in what form.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common_options.hpp"

namespace curlidar::app {

struct DecodeCommand {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string output, format, encoding = "binary", attributes = "all";
  std::string scan;
  std::string rings, azimuth, region;
  bool field_only = false, allow_truncated = false;

  std::optional<double> rows, columns;
  std::optional<double> density;
  std::string directions, sensor;
  bool mesh = false;

  std::string preset, strategy, density_profile;
  std::optional<double> min_confidence;
  bool no_masks = false, organised = false;
  bool confidence = false, normals = false, keep_originals = false, original = false;
  std::uint64_t max_points = 1ull << 28;
};

void add_decode_options(CLI::App& app, DecodeCommand& command);

}  // namespace curlidar::app
