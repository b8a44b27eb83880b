// SPDX-License-Identifier: BSD-3-Clause
// Where the sensor was, from the scans themselves: points of one scan on the surfaces of others.
//
// Iterated least squares of distances to the tangent plane at the nearest point, with a gate that
// narrows and weights that fall with the distance (Cauchy's). Scans are taken as they are: what the
// vehicle's motion during the turn did to them is not undone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/motion.hpp"
#include "curlidar/progress.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

struct RegisterSettings {
  double min_range_m = 2, max_range_m = 60;  ///< returns nearer or further are not looked at
  double target_voxel_m = 0.15;              ///< one point is kept of each cell of this size
  double source_voxel_m = 0.5;
  double first_gate_m = 1.5, gate_factor = 0.75, last_gate_m = 0.15;  ///< gate by iteration
  double weight_scale_m = 0.05;  ///< a distance from a plane that halves a point's weight
  int iterations = 25;           ///< at most
  /// Without a guess, or where the guess leads to nothing, guesses up to this far ahead and behind
  /// are tried; 0: none.
  double search_m = 10;
  /// Below this a guess is not believed and others are tried; below half of it, or where no place
  /// is clearly the best, a result is in doubt. Sensors of few rings have few matches.
  double min_matched_share = 0.5;
  /// Sequences: a scan becomes part of the local map when the sensor has gone this far or turned
  /// this much since the last that did; the map holds the latest `keyframes` of them.
  double keyframe_m = 1.5, keyframe_turn_deg = 10;
  std::size_t keyframes = 6;
  std::size_t threads = 1;  ///< 0 = all cores; never changes the result
};

/// How one scan lies on another, or on the local map.
struct Registration {
  RigidMotion T_target_source;
  double matched_share = 0;  ///< of the source's points, with a point of the target near
  double rms_m = 0;          ///< distance of matched points from the target's planes
  /// The smallest share of the planes that hold any direction of motion: near 0 in a tunnel, in
  /// which nothing says how far the sensor went.
  double weakest_share = 0;
  int iterations = 0;
  std::string doubt;  ///< why the result should not be trusted; empty if it should

  bool trusted() const { return doubt.empty(); }
};

/// The motion that takes points of `source` to the frame of `target`. Without a guess, guesses
/// along the sensor's x axis are tried and what is not clearly the best of them is in doubt. About
/// .2 s of CPU for KITTI's scans with a guess, 1 s without. Errors: invalid_argument (settings that
/// make no sense; a scan with fewer than 100 returns in range).
Result<Registration> register_pair(const Cloud& source, const Cloud& target,
                                   const std::optional<RigidMotion>& guess = {},
                                   const RegisterSettings& settings = {});

/// Scans of a drive, one after the other: each is matched with a map of those shortly before it.
/// Memory is bounded by the local map, however long the drive. Drift is small but not undone when
/// the sensor comes back to where it was.
class ScanMatcher {
 public:
  explicit ScanMatcher(const RegisterSettings& settings = {});
  ~ScanMatcher();
  ScanMatcher(ScanMatcher&&) noexcept;
  ScanMatcher& operator=(ScanMatcher&&) noexcept;

  /// The pose of the next scan: T_target_source is T_map_sensor, the identity for the first scan
  /// unless `guess` says else. `guess` is a pose to refine (its change since the last guess
  /// counts); without one the sensor is expected to go on as it did. A scan in doubt gets the
  /// guessed pose, if there is one, else the best that was found, and `doubt` set. Errors as of
  /// register_pair. About .15 s of CPU for KITTI's scans.
  Result<Registration> add(const Cloud& scan, const std::optional<RigidMotion>& guess = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// ScanMatcher on scans at hand; `guesses` is empty or holds a pose for each. Errors name the scan
/// by its number from 0.
Result<std::vector<Registration>> register_sequence(std::span<const Cloud> scans,
                                                    std::span<const RigidMotion> guesses = {},
                                                    const RegisterSettings& settings = {},
                                                    const ProgressCallback& progress = {});

}  // namespace curlidar
