// SPDX-License-Identifier: BSD-3-Clause
// encode --sequence: many scans into one file.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common_scans.hpp"
#include "curlidar/sequence.hpp"
#include "encode_plan.hpp"
#include "encode_report.hpp"

namespace curlidar::app {
namespace {

/// What has been written so far.
struct Totals {
  std::size_t scans = 0, predicted = 0, groups = 0;
  std::uint64_t returns = 0, frame_bytes = 0;
  double error_sum_m = 0;  ///< of all returns coded
  std::uint64_t coded = 0;
  double ms = 0;

  void add(const EncodedFrame& frame) {
    const EncodeReport& report = frame.report;
    ++scans;
    predicted += frame.kind == FrameKind::predicted ? 1 : 0;
    groups += frame.kind == FrameKind::first ? 1 : 0;
    returns += report.points_in;
    frame_bytes += frame.bytes.size();
    if (report.compact) {
      coded += report.points_coded;
      error_sum_m += report.compact->mean_error_m * static_cast<double>(report.points_coded);
    }
    for (const StageTime& stage : report.stages_ms) ms += stage.ms;
  }
  double mean_error_m() const {
    return error_sum_m / static_cast<double>(std::max<std::uint64_t>(coded, 1));
  }
};

double bits_a_point(std::uint64_t bytes, std::uint64_t points) {
  return 8.0 * static_cast<double>(bytes) / static_cast<double>(std::max<std::uint64_t>(points, 1));
}

/// Settings of a sequence: those of a scan, in one segment unless parts were asked for.
SequenceSettings sequence_settings(const EncodeCommand& command, const Cloud& cloud) {
  SequenceSettings settings;
  settings.encode = encode_settings(command, cloud);
  if (!command.compact.asks_for_segments()) settings.encode.compact.index = false;
  if (command.sequence.group > 0) settings.group = command.sequence.group;
  settings.still = command.sequence.still;
  return settings;
}

Json scan_json(const std::string& input, const EncodedFrame& frame) {
  const EncodeReport& report = frame.report;
  Json json = {{"input", input},
               {"kind", to_string(frame.kind)},
               {"points_in", report.points_in},
               {"points_coded", report.points_coded},
               {"bytes", frame.bytes.size()},
               {"bits_per_point", report.bits_per_point}};
  if (report.compact) {
    json["mean_error_m"] = report.compact->mean_error_m;
    json["max_error_m"] = report.compact->max_error_m;
    json["step_m"] = report.compact->step_m;
    json["breakdown"] = breakdown_json(report.compact->breakdown);
  }
  return json;
}

std::string scan_text(std::size_t number, const std::string& input, const EncodedFrame& frame) {
  return fmt::format("{:>6}  {:<9} {:>10} points {:>9} {:6.3f} bits a point  {}\n", number,
                     to_string(frame.kind), count_text(frame.report.points_in),
                     bytes_text(frame.bytes.size()), frame.report.bits_per_point, input);
}

Json summary_json(const EncodeCommand& command, const SequenceSettings& settings,
                  const Totals& totals, std::uint64_t bytes, Json scans) {
  return {{"output", command.output},
          {"profile", to_string(settings.encode.profile)},
          {"scans", totals.scans},
          {"groups", totals.groups},
          {"group", settings.group},
          {"static", settings.still},
          {"predicted", totals.predicted},
          {"points_in", totals.returns},
          {"bytes", bytes},
          {"bits_per_point", bits_a_point(bytes, totals.returns)},
          {"mean_error_m", totals.coded > 0 ? Json(totals.mean_error_m()) : Json()},
          {"encode_ms", totals.ms},
          {"frames", std::move(scans)}};
}

std::string summary_text(const EncodeCommand& command, const SequenceSettings& settings,
                         const Totals& totals, std::uint64_t bytes) {
  Table table;
  table.add({"scans", fmt::format("{}, {} predicted", count_text(totals.scans),
                                  count_text(totals.predicted))});
  table.add(
      {"groups", fmt::format("{} of up to {} scans", count_text(totals.groups), settings.group)});
  table.add({"points", count_text(totals.returns)});
  table.add({"size", bytes_text(bytes)});
  table.add({"bits per point in", fmt::format("{:.4f}", bits_a_point(bytes, totals.returns))});
  if (totals.coded > 0) table.add({"mean error", length_text(totals.mean_error_m())});
  table.add({"time", milliseconds_text(totals.ms)});
  return fmt::format("{} scans -> {}\n{}", totals.scans, command.output, table.text());
}

/// Times and poses of the scans, as far as files were given.
std::vector<ScanStamp> stamps_of(const PoseOptions& options, std::size_t scans) {
  const PoseTrack track = load_poses(options, scans);
  std::vector<ScanStamp> stamps(scans);
  for (std::size_t i = 0; i < scans; ++i) {
    if (!track.T_map_sensor.empty()) stamps[i].T_map_sensor = track.T_map_sensor[i];
    if (!track.time_s.empty()) stamps[i].time_s = track.time_s[i];
  }
  return stamps;
}

void check_output(const EncodeCommand& command) {
  if (command.output.empty() || command.output == "-" || is_directory(command.output)) {
    usage_error("--sequence makes one file: name it with -o, such as -o drive.curl");
  }
}

}  // namespace

int run_encode_sequence(const EncodeCommand& command) {
  check_output(command);
  const auto metadata = parse_metadata(command.metadata);
  ReadOptions read_options;
  read_options.format = parse_format(command.format);
  const std::vector<std::string> inputs = list_scans(command.inputs);
  refuse_coded(inputs);
  for (const std::string& input : inputs) refuse_same_file(input, command.output);

  const std::vector<ScanStamp> stamps = stamps_of(command.sequence.poses, inputs.size());

  std::optional<SequenceWriter> writer;
  SequenceSettings settings;
  Totals totals;
  Json scans = Json::array();
  ProgressBar bar(!command.common.quiet);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const ProgressCallback progress = [&](std::string_view stage, double fraction) {
      bar.update(i, inputs.size(), stage, fraction);
    };
    progress(inputs[i], 0);
    Cloud cloud = need(read_cloud(inputs[i], read_options));
    if (!writer) {
      settings = sequence_settings(command, cloud);
      writer.emplace(need(SequenceWriter::create(command.output, settings)));
    }
    set_metadata(metadata, settings.encode, inputs[i], cloud);
    auto added = writer->add(cloud, stamps[i], progress);
    if (!added) {
      throw Failure({added.error().code, fmt::format("{}: {}", inputs[i], added.error().message)},
                    exit_code_of(added.error().code));
    }
    totals.add(*added);
    bar.clear();
    if (command.common.json) {
      scans.push_back(scan_json(inputs[i], *added));
    } else {
      print_text(command.common, scan_text(i, inputs[i], *added));
      std::fflush(stdout);  // who waits for a long drive sees it grow, through a pipe as well
    }
  }
  const std::uint64_t bytes = need(writer->finish());
  print_result(command.common, {summary_json(command, settings, totals, bytes, std::move(scans)),
                                summary_text(command, settings, totals, bytes)});
  return kExitOk;
}

}  // namespace curlidar::app
