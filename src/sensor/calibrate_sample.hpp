// SPDX-License-Identifier: BSD-3-Clause
// The returns that a calibration works on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sensor/calibrate.hpp"

namespace curlidar::calibration {

inline constexpr std::uint32_t kNoColumn = 0xffffffff;

/// The usable returns of one scan, and the motion assumed to have moved them.
struct ScanSample {
  std::vector<Vec3> moved;  ///< as in the cloud
  std::vector<std::uint16_t> ring;
  std::vector<std::uint32_t> column;  ///< of an organised cloud; else kNoColumn
  std::uint32_t columns = 0;          ///< of an organised cloud; else 0
  MotionTwist motion;

  std::size_t size() const { return moved.size(); }
};

/// Returns nearer to the spin axis than this tell nothing, those farther off are none of a sensor.
inline constexpr double kNearestDistance_m = 0.3, kFarthest_m = 1e4;

/// Every return with a ring.
ScanSample all_returns(const RingedScan& scan);
/// At most about `limit` of them, taken evenly from every ring.
ScanSample thin(const ScanSample& sample, std::size_t rings, std::size_t limit);

/// A motion that leaves points alone costs nothing to undo.
Vec3 undo(const MotionTwist& motion, const Vec3& moved);

/// How a point undone at s of a turn would go if s were larger.
Vec3 point_by_turn(const MotionTwist& motion, const Vec3& point, double s);

/// An azimuth brought into [-pi, pi].
double wrapped(double angle);

}  // namespace curlidar::calibration
