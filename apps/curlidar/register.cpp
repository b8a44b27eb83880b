// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/register.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "common_scans.hpp"
#include "curlidar/pose.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar register velodyne/ -o poses.txt
  curlidar register velodyne/ --poses poses.txt --calib calib.txt -o refined.txt
  curlidar register scans/*.pcd --times times.txt --out-format tum -o poses.tum
Each scan is matched with the scans shortly before it. Poses that are given are refined: each is
expected where their change since the last scan says. A scan whose match is in doubt is an error
that names it; --keep-going writes its guessed pose with a warning instead.
docs/poses.md explains formats and frames.)";

struct Options {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string format, output, out_format = "kitti";
  PoseOptions poses;
  std::string times;
  RegisterSettings settings;
  bool keep_going = false;
};

struct Row {
  std::string input;
  Registration result;
  Vec3 step{};
  double turn_deg = 0;
  double correction_m = 0;  ///< of the given step
  double ms = 0;
};

double angle_deg(const RigidMotion& motion) {
  const auto& [x, y, z] = motion.rotation;
  const double cosine = std::clamp((x.x + y.y + z.z - 1) / 2, -1.0, 1.0);
  return std::acos(cosine) * 180 / std::numbers::pi;
}

Json row_json(const Row& row, bool given) {
  Json json = {{"input", row.input},
               {"matched_share", row.result.matched_share},
               {"rms_m", row.result.rms_m},
               {"weakest_share", row.result.weakest_share},
               {"iterations", row.result.iterations},
               {"step_m", norm(row.step)},
               {"turn_deg", row.turn_deg},
               {"correction_m", given ? Json(row.correction_m) : Json()},
               {"doubt", row.result.doubt.empty() ? Json() : Json(row.result.doubt)},
               {"register_ms", row.ms}};
  return json;
}

std::string rows_text(const std::vector<Row>& rows, bool given) {
  Table table;
  table.add({"scan", "step", "turn", given ? "corrected" : "", "matched", "rms", ""});
  for (const Row& row : rows) {
    table.add({row.input, length_text(norm(row.step)), fmt::format("{:.2f} deg", row.turn_deg),
               given ? length_text(row.correction_m) : "",
               fmt::format("{:.0f} %", 100 * row.result.matched_share),
               length_text(row.result.rms_m), row.result.trusted() ? "" : "in doubt"});
  }
  return table.text();
}

/// What a scan in doubt means for the run.
void meet_doubt(const Options& options, const std::string& input, const Registration& result) {
  if (result.trusted()) return;
  const std::string told =
      fmt::format("{}: the match with the scans before is in doubt: {}", input, result.doubt);
  if (options.keep_going) {
    print_warning(told);
    return;
  }
  throw Failure({ErrorCode::invalid_argument,
                 told + ". Give scans nearer to each other, poses to start from (--poses), or "
                        "--keep-going to take the guessed pose"},
                kExitInput);
}

Row match_scan(const Options& options, const std::string& input, ScanMatcher& matcher,
               const std::optional<RigidMotion>& guess) {
  const Cloud cloud = load_cloud(input, parse_format(options.format));
  const auto start = std::chrono::steady_clock::now();
  const Result<Registration> result = matcher.add(cloud, guess);
  if (!result)
    throw Failure({result.error().code, input + ": " + result.error().message}, kExitInput);
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
  Row row;
  row.input = input;
  row.result = *result;
  row.ms = spent.count();
  return row;
}

void measure_steps(std::vector<Row>& rows, const std::vector<RigidMotion>& given) {
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const RigidMotion step =
        rows[k - 1].result.T_target_source.inverse() * rows[k].result.T_target_source;
    rows[k].step = step.move;
    rows[k].turn_deg = angle_deg(step);
    if (given.empty()) continue;
    rows[k].correction_m = norm(step.move - (given[k - 1].inverse() * given[k]).move);
  }
}

int run(const Options& options) {
  refuse_mixed_stdout(options.common, options.output);
  const PoseFormat out_format = need_option(pose_format_by_name(options.out_format));
  const std::vector<std::string> inputs = list_scans(options.inputs);
  for (const std::string& input : inputs) refuse_same_file(input, options.output);
  PoseTrack given = load_poses(options.poses, inputs.size());
  if (out_format == PoseFormat::tum && given.time_s.empty()) {
    usage_error("--out-format tum needs --times, or --poses with times");
  }
  RegisterSettings settings = options.settings;
  settings.threads = options.common.threads;
  ScanMatcher matcher(settings);
  std::vector<Row> rows;
  ProgressBar bar(!options.common.quiet);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    bar.update(k, inputs.size(), inputs[k], 0);
    const auto guess =
        given.T_map_sensor.empty() ? std::nullopt : std::optional(given.T_map_sensor[k]);
    rows.push_back(match_scan(options, inputs[k], matcher, guess));
    if (!rows.back().result.trusted()) bar.clear();
    meet_doubt(options, inputs[k], rows.back().result);
  }
  bar.clear();
  measure_steps(rows, given.T_map_sensor);
  PoseTrack track;
  track.time_s = given.time_s;
  Json scans = Json::array();
  double length = 0;
  for (const Row& row : rows) {
    track.T_map_sensor.push_back(row.result.T_target_source);
    scans.push_back(row_json(row, !given.T_map_sensor.empty()));
    length += norm(row.step);
  }
  need(write_poses(options.output, track, out_format));
  const Json json = {{"output", options.output},
                     {"format", to_string(out_format)},
                     {"length_m", length},
                     {"scans", scans}};
  const std::string text =
      fmt::format("{}: {} poses over {}\n{}", options.output, rows.size(), length_text(length),
                  rows_text(rows, !given.T_map_sensor.empty()));
  print_result(options.common, {json, text}, options.output == "-");
  return kExitOk;
}

}  // namespace

Command add_register(CLI::App& root) {
  CLI::App* app = root.add_subcommand("register", "Poses of scans, found or refined by matching");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("SCANS", options->inputs,
                  "Scans in the order of the drive; a directory stands for its files by name")
      ->required();
  app->add_option("-o,--output", options->output, "Poses to write; - is standard output")
      ->required();
  app->add_option("--format", options->format,
                  fmt::format("Format of the scans: {}; default by content", kFormatNames));
  app->add_option("--out-format", options->out_format, "kitti, tum, matrix or csv")
      ->capture_default_str();
  add_pose_options(*app, options->poses);
  app->add_option("--min-range", options->settings.min_range_m, "Leave out what is nearer, metres")
      ->capture_default_str()
      ->check(number_in(0.0, 1e6));
  app->add_option("--max-range", options->settings.max_range_m, "Leave out what is further, metres")
      ->capture_default_str()
      ->check(number_in(0.0, 1e6));
  app->add_option("--search", options->settings.search_m,
                  "Without a guess, look this far ahead and behind, metres")
      ->capture_default_str()
      ->check(number_in(0.0, 100.0));
  app->add_flag("--keep-going", options->keep_going,
                "Write the guessed pose of a scan in doubt, with a warning");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
