// SPDX-License-Identifier: BSD-3-Clause
// Scans and poses of `map build` and `map append`.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "map.hpp"
#include "scan_source.hpp"

namespace curlidar::app {
namespace {

namespace fs = std::filesystem;

/// What is wrong before the first scan is read need not wait for the last one.
void check_files(const std::vector<std::string>& scans, const MapInputs& inputs,
                 const std::string& output) {
  for (const std::string& scan : scans) {
    refuse_same_file(scan, output);
    std::error_code error;
    if (scan == "-" || fs::exists(scan, error)) continue;
    throw Failure({ErrorCode::not_found, scan + ": no such scan"}, kExitFile);
  }
  refuse_same_file(inputs.poses.path, output);
  if (output == "-") return;
  const fs::path folder = fs::path(output).parent_path();
  if (::access(folder.empty() ? "." : folder.c_str(), W_OK | X_OK) != 0) {
    throw Failure({ErrorCode::io, fmt::format("{}: cannot write into its folder: {}", output,
                                              std::generic_category().message(errno))},
                  kExitFile);
  }
}

/// Those of --poses, or those that sequences bring along.
PoseTrack poses_for(const PoseOptions& options, ScanSource& scans) {
  if (!options.path.empty()) return load_poses(options, scans.size());
  if (!scans.has_poses()) {
    usage_error(
        "--poses is needed, a pose for each scan; only sequences with poses bring their own");
  }
  PoseTrack track = load_poses(options, scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const ScanStamp stamp = scans.stamp(i);
    track.T_map_sensor.push_back(*stamp.T_map_sensor);
    if (options.times.empty() && stamp.time_s) track.time_s.push_back(*stamp.time_s);
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
  add_pose_options(app, inputs.poses);
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
  check_files(list_scans(inputs.inputs), inputs, output);
  ScanSource scans(inputs.inputs, {parse_format(inputs.format), common.threads});
  const PoseTrack track = poses_for(inputs.poses, scans);
  ProgressBar bar(!common.quiet);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    bar.update(0, 1, fmt::format("scan {} of {}", i + 1, scans.size()),
               0.8 * static_cast<double>(i) / static_cast<double>(scans.size()));
    const RigidMotion& pose = track.T_map_sensor[i];
    if (!builder.takes(pose)) {
      builder.skip(pose);
      continue;
    }
    const Cloud cloud = scans.cloud(i);
    std::optional<double> time_s;
    if (track.time_s.size() == scans.size()) time_s = track.time_s[i];
    const auto added = builder.add_scan(cloud, pose, time_s);
    if (!added) {
      throw Failure(
          {added.error().code, fmt::format("{}: {}", scans.name(i), added.error().message)},
          exit_code_of(added.error().code));
    }
  }
  const MapReport report =
      need(builder.finish(output, [&](std::string_view stage, double fraction) {
        bar.update(0, 1, stage, 0.8 + 0.2 * fraction);
      }));
  bar.clear();
  for (const std::string& note : report.notes) print_warning(note);
  if (report.taken > 0 && report.points == 0) {
    print_warning("no return lies from --min-range to --max-range: nothing new is in the map");
  }
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
