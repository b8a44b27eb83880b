// SPDX-License-Identifier: BSD-3-Clause
#include "encode_plan.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <utility>

#include "curlidar/sequence.hpp"

namespace curlidar::app {
namespace {

/// A geometry-only file of the compact profile holds no metadata that nobody asked for.
bool keeps_metadata(const EncodeSettings& settings) {
  return settings.profile != Profile::compact || !settings.attributes ||
         !settings.attributes->empty();
}

void add_sequence_options(CLI::App& app, SequenceOptions& options) {
  const char* group = "Sequences";
  CLI::Option* sequence = app.add_flag("--sequence", options.sequence,
                                       "All inputs, in their order, into the one file of -o; "
                                       "folders are sorted by name");
  sequence->group(group);
  const auto of_sequences = [&](CLI::Option* option) { option->needs(sequence)->group(group); };
  of_sequences(app.add_option("--group", options.group,
                              fmt::format("Scans of a group: a scan may be predicted from the one "
                                          "before, the first of a group is not; default {}",
                                          kSequenceGroup))
                   ->check(number_in(1, kMaxSequenceGroup)));
  of_sequences(app.add_flag("--static", options.still, "The sensor stands still"));
  add_pose_options(app, options.poses);
}

}  // namespace

void add_encode_options(CLI::App& app, EncodeCommand& command) {
  app.add_option("inputs", command.inputs, "Scans, of a sequence also folders; - is standard input")
      ->required();
  app.add_option("-o,--output", command.output,
                 "File, or directory for many inputs; default beside the input, - is standard "
                 "output");
  app.add_option("--format", command.format,
                 fmt::format("Format of the input: {}; default by content", kFormatNames));
  app.add_option("--meta", command.metadata, "key=value kept in the file; repeatable")
      ->allow_extra_args(false);
  add_sequence_options(app, command.sequence);
  command.compact.add(app);
  command.paper.add_grid(app);
  command.paper.add_upsample(app);
  command.paper.add_cliffs(app);
  command.paper.add_fit(app, "compact");
  add_common_options(app, command.common);
}

EncodeSettings encode_settings(const EncodeCommand& command, const Cloud& cloud) {
  EncodeSettings settings = command.paper.settings(cloud, command.common.threads);
  if (settings.profile == Profile::compact) {
    command.compact.apply(settings.compact);
    need_option(validate(settings.compact));
    if (!settings.compact.keep_order && !keeps_every_return(settings.compact)) {
      usage_error("a depth image has its own order: leave --any-order out, or columns and ranges");
    }
  } else if (!command.compact.first_given().empty()) {
    usage_error(fmt::format("{} belongs to the compact profile: leave --profile {} out",
                            command.compact.first_given(), to_string(settings.profile)));
  }
  return settings;
}

void refuse_poses(const PoseOptions& poses) {
  if (poses.path.empty() && poses.calib.empty() && poses.times.empty() && poses.format.empty()) {
    return;
  }
  usage_error("--poses, --times and what belongs to them are kept in sequences: add --sequence");
}

void refuse_coded(const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    if (input.ends_with(".curl")) {
      usage_error(
          fmt::format("{} is encoded already; 'curlidar decode' makes a cloud of it", input));
    }
  }
}

std::map<std::string, std::string> parse_metadata(const std::vector<std::string>& pairs) {
  std::map<std::string, std::string> metadata;
  for (const std::string& pair : pairs) {
    const std::size_t equals = pair.find('=');
    if (equals == 0 || equals == std::string::npos) {
      usage_error(fmt::format("--meta '{}': give key=value, such as frame_id=velodyne", pair));
    }
    metadata[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return metadata;
}

void set_metadata(const std::map<std::string, std::string>& metadata,
                  const EncodeSettings& settings, const std::string& name, Cloud& cloud) {
  if (!keeps_metadata(settings)) {
    cloud.metadata.clear();
  } else if (name != "-") {
    cloud.metadata["source"] = std::filesystem::path(name).filename().string();
  }
  for (const auto& [key, value] : metadata) cloud.metadata[key] = value;
}

}  // namespace curlidar::app
