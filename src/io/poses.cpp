// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/pose.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "io/pose_text.hpp"

namespace curlidar {
namespace {

using io::Source;

const char* name_of(const std::string& path) {
  return path == "-" ? "standard input" : path.c_str();
}

/// Lines of a text file, and what is needed to tell where an error is.
struct TextFile {
  std::string name;
  std::vector<std::byte> bytes;
  ReadLimits limits;

  Source source() const { return {bytes, name, limits}; }
};

Result<TextFile> open_text(const std::string& path) {
  CURLIDAR_TRY_ASSIGN(bytes, read_file(path));
  return TextFile{name_of(path), std::move(bytes), {}};
}

/// How much of a way leads along each axis of the sensor's own frame, summed with signs.
struct OwnWay {
  Vec3 along{};
  double length_m = 0;
};

OwnWay own_way(const std::vector<RigidMotion>& poses) {
  OwnWay way;
  for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
    const Vec3 step = poses[k].undo(poses[k + 1].move);
    way.along = way.along + step;
    way.length_m += norm(step);
  }
  return way;
}

/// Vehicles drive ahead: what moves along another axis is most likely in another frame.
void warn_of_frames(PoseTrack& track, const std::string& name, bool with_calibration) {
  constexpr double kEnoughWay_m = 2, kMostOfIt = 0.8;
  const OwnWay way = own_way(track.T_map_sensor);
  if (way.length_m < kEnoughWay_m) return;
  if (!with_calibration && way.along.z > kMostOfIt * way.length_m) {
    track.warnings.push_back(
        fmt::format("{}: the sensor moves along its z axis, as a camera does and a LiDAR does not. "
                    "If these are camera poses, give the calibration (calib.txt), too",
                    name));
  }
  if (with_calibration && std::abs(way.along.y) > kMostOfIt * way.length_m) {
    track.warnings.push_back(
        fmt::format("{}: with the calibration the sensor moves sideways. If these are poses of the "
                    "LiDAR already, leave the calibration out",
                    name));
  }
}

void warn_of_times(PoseTrack& track, const std::string& name) {
  for (std::size_t k = 1; k < track.time_s.size(); ++k) {
    if (track.time_s[k] >= track.time_s[k - 1]) continue;
    track.warnings.push_back(fmt::format("{}: time goes back at pose {} ({} s after {} s)", name, k,
                                         track.time_s[k], track.time_s[k - 1]));
    return;
  }
}

}  // namespace

const char* to_string(PoseFormat format) {
  switch (format) {
    case PoseFormat::kitti:
      return "kitti";
    case PoseFormat::tum:
      return "tum";
    case PoseFormat::matrix:
      return "matrix";
    case PoseFormat::csv:
      return "csv";
  }
  return "?";
}

Result<PoseFormat> pose_format_by_name(std::string_view name) {
  for (const PoseFormat format :
       {PoseFormat::kitti, PoseFormat::tum, PoseFormat::matrix, PoseFormat::csv}) {
    if (name == to_string(format)) return format;
  }
  return Error{ErrorCode::invalid_argument,
               fmt::format("no format of poses is called {}: choose kitti, tum, matrix or csv",
                           io::quoted(name))};
}

Result<PoseTrack> parse_poses(std::span<const std::byte> bytes, const std::string& name,
                              std::optional<PoseFormat> format) {
  const ReadLimits limits;
  const Source source{bytes, name, limits};
  CURLIDAR_TRY_ASSIGN(lines, io::content_lines(source));
  if (lines.empty()) return Error{ErrorCode::corrupt, name + ": no pose in it"};
  if (!format) {
    CURLIDAR_TRY_ASSIGN(told, io::tell_pose_format(source, lines));
    format = told;
  }
  CURLIDAR_TRY_ASSIGN(track, io::parse_pose_lines(source, lines, *format));
  if (track.T_map_sensor.empty()) return Error{ErrorCode::corrupt, name + ": no pose in it"};
  return track;
}

Result<std::vector<double>> read_times(const std::string& path) {
  CURLIDAR_TRY_ASSIGN(file, open_text(path));
  CURLIDAR_TRY_ASSIGN(lines, io::content_lines(file.source()));
  std::vector<double> times;
  for (const io::NumberedLine& line : lines) {
    CURLIDAR_TRY_ASSIGN(numbers, io::line_numbers(file.source(), line, 1));
    times.push_back(numbers.front());
  }
  return times;
}

Result<RigidMotion> read_calibration(const std::string& path) {
  CURLIDAR_TRY_ASSIGN(file, open_text(path));
  const Source source = file.source();
  CURLIDAR_TRY_ASSIGN(lines, io::content_lines(source));
  std::vector<double> rotation, move;
  std::size_t rotation_line = 0;
  for (io::NumberedLine line : lines) {
    const std::size_t colon = line.text.find(':');
    if (colon == std::string_view::npos) continue;
    const std::string_view key = line.text.substr(0, colon);
    line.text.remove_prefix(colon + 1);
    if (key == "Tr" || key == "Tr_velo_to_cam") {
      CURLIDAR_TRY_ASSIGN(numbers, io::line_numbers(source, line, 12));
      return io::motion_of_matrix(source, line.number, numbers);
    }
    if (key == "R") {
      CURLIDAR_TRY_ASSIGN(numbers, io::line_numbers(source, line, 9));
      rotation = std::move(numbers);
      rotation_line = line.number;
    } else if (key == "T") {
      CURLIDAR_TRY_ASSIGN(numbers, io::line_numbers(source, line, 3));
      move = std::move(numbers);
    }
  }
  if (rotation.empty() || move.empty()) {
    return Error{ErrorCode::corrupt,
                 fmt::format("{}: no line 'Tr:' of 12 numbers, which takes the LiDAR's points to "
                             "the camera (KITTI's calib.txt; or 'Tr_velo_to_cam:', or 'R:' and "
                             "'T:')",
                             file.name)};
  }
  std::vector<double> rows;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) rows.push_back(rotation[3 * row + column]);
    rows.push_back(move[row]);
  }
  return io::motion_of_matrix(source, rotation_line, rows);
}

void camera_to_sensor(PoseTrack& track, const RigidMotion& T_camera_sensor) {
  const RigidMotion T_sensor_camera = T_camera_sensor.inverse();
  for (RigidMotion& pose : track.T_map_sensor) pose = T_sensor_camera * pose * T_camera_sensor;
}

Result<PoseTrack> read_poses(const std::string& path, const PoseReadOptions& options) {
  CURLIDAR_TRY_ASSIGN(bytes, read_file(path));
  const std::string name = name_of(path);
  CURLIDAR_TRY_ASSIGN(track, parse_poses(bytes, name, options.format));
  if (!options.times_path.empty()) {
    CURLIDAR_TRY_ASSIGN(times, read_times(options.times_path));
    if (times.size() != track.T_map_sensor.size()) {
      return Error{
          ErrorCode::corrupt,
          fmt::format("{} has {} times, {} has {} poses: there must be one for each",
                      name_of(options.times_path), times.size(), name, track.T_map_sensor.size())};
    }
    track.time_s = std::move(times);
  }
  if (!options.calib_path.empty()) {
    CURLIDAR_TRY_ASSIGN(T_camera_sensor, read_calibration(options.calib_path));
    camera_to_sensor(track, T_camera_sensor);
  }
  warn_of_frames(track, name, !options.calib_path.empty());
  warn_of_times(track, options.times_path.empty() ? name : name_of(options.times_path));
  return track;
}

}  // namespace curlidar
