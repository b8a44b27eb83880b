// SPDX-License-Identifier: BSD-3-Clause
// Poses of a moving sensor: text files in, text files out. docs/poses.md explains the conventions.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/motion.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// Where a sensor was, scan by scan. A pose takes points from the sensor's frame (x ahead, y to the
/// left, z up) to the map's.
struct PoseTrack {
  std::vector<RigidMotion> T_map_sensor;
  std::vector<double> time_s;         ///< empty, or one for each pose
  std::vector<std::string> warnings;  ///< what looks wrong but may be meant
};

enum class PoseFormat {
  kitti,   ///< the 12 numbers of a 3 x 4 matrix on a line, row by row
  tum,     ///< "time x y z qx qy qz qw" on a line, seconds and metres
  matrix,  ///< 3 x 4 or 4 x 4 matrices, a row of 4 numbers on a line, or all 16 numbers on one
  csv,     ///< a line of names, then numbers: [time] x y z and qx qy qz qw or r00 .. r22
};

const char* to_string(PoseFormat format);
/// Accepts the names of to_string. Errors: invalid_argument.
Result<PoseFormat> pose_format_by_name(std::string_view name);

struct PoseReadOptions {
  std::optional<PoseFormat> format;  ///< otherwise told by the content
  /// KITTI's calib.txt, empty if none: the poses are then those of the camera, and become
  /// T_map_sensor = Tr^-1 T Tr with the file's Tr = T_camera_sensor.
  std::string calib_path;
  /// A file of one time in seconds on each line, as many as there are poses; empty if none. It
  /// replaces times of the poses' own file.
  std::string times_path;
};

/// Reads poses; "-" is standard input. Lines that start with # or // are comments. Rotations must
/// be orthonormal with determinant +1 and quaternions of length 1, within .001: what is left of an
/// error is then taken out. Warns of poses that look like a camera's (motion along z) and of times
/// that go back. Errors name the file and the line: not_found, io; corrupt (not poses, or not as
/// many times); invalid_argument.
Result<PoseTrack> read_poses(const std::string& path, const PoseReadOptions& options = {});

/// The poses in the bytes of a file, as they stand there; `name` is used for messages.
Result<PoseTrack> parse_poses(std::span<const std::byte> bytes, const std::string& name,
                              std::optional<PoseFormat> format = {});

/// T_camera_sensor of a calibration file of KITTI: its line "Tr:" (odometry) or "Tr_velo_to_cam:"
/// (object), or its lines "R:" and "T:" (raw). Errors as of read_poses.
Result<RigidMotion> read_calibration(const std::string& path);

/// Poses of a camera made those of a sensor that is fixed to it: Tr^-1 T Tr.
void camera_to_sensor(PoseTrack& track, const RigidMotion& T_camera_sensor);

/// Writes poses; "-" is standard output. Numbers are the shortest that read back the same, so that
/// matrices are exact and quaternions exact to rounding. Times are written by tum, which needs
/// them, and by csv. Atomic. Errors: invalid_argument (times missing, or not as many as poses; not
/// finite), io.
Status write_poses(const std::string& path, const PoseTrack& track,
                   PoseFormat format = PoseFormat::kitti);
/// What write_poses writes.
Result<std::string> format_poses(const PoseTrack& track, PoseFormat format);
/// The times of a file with one on each line. Errors as of read_poses.
Result<std::vector<double>> read_times(const std::string& path);
/// One time on each line, as KITTI's times.txt has them. Atomic.
Status write_times(const std::string& path, std::span<const double> time_s);

}  // namespace curlidar
