// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "curlidar/pose.hpp"

namespace curlidar {
namespace {

/// The quaternion of a rotation with w >= 0, as x, y, z, w.
std::array<double, 4> quaternion_of(const RigidMotion& pose) {
  Eigen::Matrix3d matrix;
  for (int row = 0; row < 3; ++row) {
    const Vec3& r = pose.rotation[static_cast<std::size_t>(row)];
    matrix.row(row) << r.x, r.y, r.z;
  }
  Eigen::Quaterniond q(matrix);
  q.normalize();
  const double sign = q.w() < 0 ? -1 : 1;
  return {sign * q.x(), sign * q.y(), sign * q.z(), sign * q.w()};
}

std::string quaternion_text(const RigidMotion& pose, char between) {
  const auto [x, y, z, w] = quaternion_of(pose);
  const Vec3& p = pose.move;
  return fmt::format("{1}{0}{2}{0}{3}{0}{4}{0}{5}{0}{6}{0}{7}\n", between, p.x, p.y, p.z, x, y, z,
                     w);
}

/// The three rows of a pose with `between` after each of the first two.
std::string rows_text(const RigidMotion& pose, char between) {
  const auto row = [&](std::size_t i, double move) {
    const Vec3& r = pose.rotation[i];
    return fmt::format("{} {} {} {}", r.x, r.y, r.z, move);
  };
  return row(0, pose.move.x) + between + row(1, pose.move.y) + between + row(2, pose.move.z);
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Status check_track(const PoseTrack& track, PoseFormat format) {
  const std::size_t poses = track.T_map_sensor.size();
  if (!track.time_s.empty() && track.time_s.size() != poses) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{} times of {} poses cannot be written", track.time_s.size(), poses)};
  }
  if (format == PoseFormat::tum && track.time_s.empty()) {
    return Error{ErrorCode::invalid_argument,
                 "poses in the format tum need times: give them (times.txt), or choose kitti, "
                 "matrix or csv"};
  }
  for (std::size_t k = 0; k < poses; ++k) {
    const auto& [rotation, move] = track.T_map_sensor[k];
    const bool finite = is_finite(rotation[0]) && is_finite(rotation[1]) &&
                        is_finite(rotation[2]) && is_finite(move) &&
                        (track.time_s.empty() || std::isfinite(track.time_s[k]));
    if (!finite) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("pose {} is not finite and cannot be written", k)};
    }
  }
  return {};
}

Status write_text(const std::string& path, const std::string& text) {
  return write_file(path, std::as_bytes(std::span(text)));
}

}  // namespace

Result<std::string> format_poses(const PoseTrack& track, PoseFormat format) {
  CURLIDAR_TRY(check_track(track, format));
  const bool times = !track.time_s.empty();
  std::string text;
  if (format == PoseFormat::tum) text = "# time x y z qx qy qz qw\n";
  if (format == PoseFormat::csv) text = times ? "time,x,y,z,qx,qy,qz,qw\n" : "x,y,z,qx,qy,qz,qw\n";
  for (std::size_t k = 0; k < track.T_map_sensor.size(); ++k) {
    const RigidMotion& pose = track.T_map_sensor[k];
    switch (format) {
      case PoseFormat::kitti:
        text += rows_text(pose, ' ') + "\n";
        break;
      case PoseFormat::matrix:
        text += rows_text(pose, '\n') + "\n0 0 0 1\n\n";
        break;
      case PoseFormat::tum:
        text += fmt::format("{} ", track.time_s[k]) + quaternion_text(pose, ' ');
        break;
      case PoseFormat::csv:
        if (times) text += fmt::format("{},", track.time_s[k]);
        text += quaternion_text(pose, ',');
        break;
    }
  }
  return text;
}

Status write_poses(const std::string& path, const PoseTrack& track, PoseFormat format) {
  CURLIDAR_TRY_ASSIGN(text, format_poses(track, format));
  return write_text(path, text);
}

Status write_times(const std::string& path, std::span<const double> time_s) {
  std::string text;
  for (const double time : time_s) text += fmt::format("{}\n", time);
  return write_text(path, text);
}

}  // namespace curlidar
