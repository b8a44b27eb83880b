// SPDX-License-Identifier: BSD-3-Clause
// Text that may be poses: what is taken are motions, which are written and read again as they are.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "base/bytes.hpp"
#include "curlidar/pose.hpp"

namespace curlidar::test {

inline bool is_motion(const RigidMotion& pose) {
  const auto& r = pose.rotation;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (!(std::abs(dot(r[i], r[j]) - (i == j ? 1 : 0)) < 1e-9)) return false;
    }
  }
  return dot(cross(r[0], r[1]), r[2]) > 0 && std::isfinite(pose.move.x) &&
         std::isfinite(pose.move.y) && std::isfinite(pose.move.z);
}

/// What is wrong with the poses that a text is read as; empty if nothing is.
inline std::string read_as_poses(ByteSpan bytes, std::optional<PoseFormat> format) {
  const auto track = parse_poses(bytes, "fuzz", format);
  if (!track) return track.error().message.empty() ? "an error without a word" : "";
  if (track->T_map_sensor.empty()) return "no poses and no error";
  if (!track->time_s.empty() && track->time_s.size() != track->T_map_sensor.size()) {
    return "not as many times as poses";
  }
  // A pose takes more text than this.
  if (track->T_map_sensor.size() > bytes.size() / 8 + 1) return "more poses than the text can hold";
  for (const RigidMotion& pose : track->T_map_sensor) {
    if (!is_motion(pose)) return "a pose that is no motion";
  }
  for (const double time_s : track->time_s) {
    if (!std::isfinite(time_s)) return "a time that is none";
  }
  const auto text = format_poses(*track, PoseFormat::kitti);
  if (!text) return "poses that cannot be written: " + text.error().message;
  const auto again = parse_poses(std::as_bytes(std::span(*text)), "again", PoseFormat::kitti);
  if (!again) return "what was written cannot be read: " + again.error().message;
  if (again->T_map_sensor.size() != track->T_map_sensor.size()) return "poses got lost";
  for (std::size_t k = 0; k < again->T_map_sensor.size(); ++k) {
    // Exact up to the last bits of taking the rest of an error out once more.
    if (again->T_map_sensor[k].move != track->T_map_sensor[k].move) return "a pose came back moved";
  }
  return "";
}

/// As what the text tells itself, and as each format.
inline std::string poses_target(ByteSpan bytes) {
  for (const auto format : {std::optional<PoseFormat>{}, std::optional{PoseFormat::kitti},
                            std::optional{PoseFormat::tum}, std::optional{PoseFormat::matrix},
                            std::optional{PoseFormat::csv}}) {
    if (std::string fault = read_as_poses(bytes, format); !fault.empty()) return fault;
  }
  return "";
}

}  // namespace curlidar::test
