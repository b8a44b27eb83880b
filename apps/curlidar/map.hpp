// SPDX-License-Identifier: BSD-3-Clause
// The commands of `curlidar map`, each in the file of its name, and what they share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common_inputs.hpp"
#include "common_options.hpp"
#include "common_scans.hpp"
#include "curlidar/map.hpp"

namespace curlidar::app {

Command add_map_build(CLI::App& map);
Command add_map_append(CLI::App& map);
Command add_map_info(CLI::App& map);
Command add_map_extract(CLI::App& map);
Command add_map_sample(CLI::App& map);
Command add_map_compare(CLI::App& map);
Command add_map_render(CLI::App& map);

/// The map, with warnings of what is missing; Failure.
MapFile load_map(const std::string& path, bool allow_truncated = false);
/// What `map info` tells.
Outcome map_outcome(const std::string& path, const MapFile& map);

/// "1,2.5,-3" as `count` numbers; Failure(kExitUsage).
std::vector<double> parse_numbers(const std::string& text, const char* option, std::size_t count);

/// Scans and poses of `map build` and `map append`.
struct MapInputs {
  std::vector<std::string> inputs;
  std::string format, every = "1", output;
  PoseOptions poses;
  bool still = false;
  double max_memory_mb = 100;
};
void add_map_inputs(CLI::App& app, MapInputs& inputs);
/// Offers all scans to the builder and writes the map.
Outcome build_map(const CommonOptions& common, const MapInputs& inputs, MapBuilder& builder,
                  const std::string& output);
/// What --every, --still and memory say.
void apply(const MapInputs& inputs, MapBuildSettings& settings);

}  // namespace curlidar::app
