// SPDX-License-Identifier: BSD-3-Clause
#include "info_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "curlidar/pose.hpp"
#include "curlidar/sequence.hpp"

namespace curlidar::app {
namespace {

/// What is known of the scans that are there.
struct Listing {
  Json scans = Json::array(), damaged = Json::array();
  Table table;
  std::size_t predicted = 0;
  std::uint64_t returns = 0;
  PoseTrack track;
  std::size_t told = 0;  ///< scans
};

double bits_a_return(std::uint64_t bytes, std::uint64_t returns) {
  return 8.0 * static_cast<double>(bytes) /
         static_cast<double>(std::max<std::uint64_t>(returns, 1));
}

Json pose_json(const RigidMotion& pose) {
  Json rows = Json::array();
  const double move[3]{pose.move.x, pose.move.y, pose.move.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& row = pose.rotation[i];
    rows.push_back({row.x, row.y, row.z, move[i]});
  }
  return rows;
}

void add_scan(std::size_t number, const SequenceScan& scan, Listing& listing) {
  const ScanStamp& stamp = scan.stamp;
  const double bits = bits_a_return(scan.bytes, scan.returns);
  listing.scans.push_back(
      {{"scan", number},
       {"time_s", stamp.time_s ? Json(*stamp.time_s) : Json()},
       {"kind", to_string(scan.kind)},
       {"group", scan.group},
       {"bytes", scan.bytes},
       {"returns", scan.returns},
       {"bits_per_point", bits},
       {"T_map_sensor", stamp.T_map_sensor ? pose_json(*stamp.T_map_sensor) : Json()}});
  std::string place;
  if (stamp.T_map_sensor) {
    const Vec3& at = stamp.T_map_sensor->move;
    place = fmt::format("({:.2f}, {:.2f}, {:.2f})", at.x, at.y, at.z);
  }
  listing.table.add({std::to_string(number),
                     stamp.time_s ? fmt::format("{:.6f}", *stamp.time_s) : "", to_string(scan.kind),
                     std::to_string(scan.group), bytes_text(scan.bytes), count_text(scan.returns),
                     fmt::format("{:.3f}", bits), place});
  listing.predicted += scan.kind == FrameKind::predicted ? 1 : 0;
  listing.returns += scan.returns;
  if (stamp.time_s) listing.track.time_s.push_back(*stamp.time_s);
  if (stamp.T_map_sensor) listing.track.T_map_sensor.push_back(*stamp.T_map_sensor);
  ++listing.told;
}

Listing list_scans(SequenceFile& sequence) {
  Listing listing;
  listing.table.add(
      {"scan", "time, s", "kind", "group", "size", "points", "bits a point", "sensor at, m"});
  for (const SequencePart& group : sequence.groups()) {
    if (group.scans == 0) {  // of a damaged group without an index nobody knows how many
      listing.damaged.push_back({{"first_scan", group.first_scan},
                                 {"scans", nullptr},
                                 {"error", fmt::format("a group of {} bytes after scan {}",
                                                       group.bytes, group.first_scan)}});
    }
    for (std::uint64_t i = 0; i < group.scans; ++i) {
      const auto number = static_cast<std::size_t>(group.first_scan + i);
      const auto scan = sequence.scan(number);
      if (scan) {
        add_scan(number, *scan, listing);
        continue;
      }
      listing.damaged.push_back({{"first_scan", group.first_scan},
                                 {"scans", group.scans},
                                 {"error", scan.error().message}});
      break;
    }
  }
  return listing;
}

PoseFormat pose_format_of(const std::string& path) {
  if (path.ends_with(".csv")) return PoseFormat::csv;
  return path.ends_with(".tum") ? PoseFormat::tum : PoseFormat::kitti;
}

void write_stamps(const std::string& path, const Listing& listing, const std::string& poses_out,
                  const std::string& times_out) {
  const PoseTrack& track = listing.track;
  const auto lacks = [&](const char* what) {
    throw Failure({ErrorCode::not_found, fmt::format("{}: not every scan has a {}", path, what)},
                  kExitInput);
  };
  if (!poses_out.empty()) {
    if (track.T_map_sensor.size() != listing.told) lacks("pose");
    need(write_poses(poses_out, track, pose_format_of(poses_out)));
  }
  if (!times_out.empty()) {
    if (track.time_s.size() != listing.told) lacks("time");
    need(write_times(times_out, track.time_s));
  }
}

}  // namespace

Outcome describe_sequence(const std::string& path, const SequenceInfoOptions& options) {
  SequenceReadOptions reading;
  reading.allow_truncated = options.allow_truncated;
  SequenceFile sequence = need(SequenceFile::open(path, reading));
  const Listing listing = list_scans(sequence);
  std::string text = fmt::format("{}\n", path);
  const auto line = [&](const char* key, const std::string& value) {
    text += fmt::format("  {:<12} {}\n", key, value);
  };
  const double bits = bits_a_return(sequence.bytes(), listing.returns);
  line("sequence", fmt::format("{} scans, {} predicted{}", count_text(sequence.scans()),
                               count_text(listing.predicted),
                               sequence.still() ? ", the sensor stands still" : ""));
  line("groups", fmt::format("{} of up to {} scans", count_text(sequence.groups().size()),
                             sequence.group_size()));
  line("points", count_text(listing.returns));
  line("size", fmt::format("{}, {:.4f} bits a point", bytes_text(sequence.bytes()), bits));
  text += "scans:\n" + listing.table.text();
  for (const Json& group : listing.damaged) {
    text += fmt::format("DAMAGED: {}\n", group["error"].get<std::string>());
  }
  for (const std::string& missing : sequence.missing()) text += "MISSING: " + missing + "\n";
  write_stamps(path, listing, options.poses_out, options.times_out);
  const Json json = {{"kind", "sequence"},
                     {"scans", sequence.scans()},
                     {"predicted", listing.predicted},
                     {"groups", sequence.groups().size()},
                     {"group", sequence.group_size()},
                     {"static", sequence.still()},
                     {"points", listing.returns},
                     {"bytes", sequence.bytes()},
                     {"bits_per_point", bits},
                     {"frames", listing.scans},
                     {"damaged", listing.damaged},
                     {"missing", sequence.missing()}};
  const bool whole = listing.damaged.empty() && sequence.missing().empty();
  return {json, text, whole ? kExitOk : kExitInput};
}

}  // namespace curlidar::app
