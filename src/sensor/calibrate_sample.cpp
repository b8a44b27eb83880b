// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/calibrate_sample.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curlidar::calibration {
namespace {

/// Columns of an organised cloud run along the rows, or down them where rows are the turns.
bool rings_are_columns(const RingedScan& scan) {
  const Cloud& cloud = *scan.cloud;
  const std::size_t rings = scan.rings->sensor.rings.size();
  return cloud.width == rings && cloud.height != rings;
}

void append(ScanSample& out, const ScanSample& from, std::size_t i) {
  out.moved.push_back(from.moved[i]);
  out.ring.push_back(from.ring[i]);
  out.column.push_back(from.column[i]);
}

}  // namespace

ScanSample all_returns(const RingedScan& scan) {
  const Cloud& cloud = *scan.cloud;
  const bool transposed = rings_are_columns(scan);
  ScanSample out;
  if (cloud.organised()) out.columns = transposed ? cloud.height : cloud.width;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::uint16_t ring = scan.rings->ring_of_point[i];
    const Vec3& p = cloud.positions[i];
    if (ring == kNoRing || std::hypot(p.x, p.y) < kNearestDistance_m) continue;
    if (!(norm(p) < kFarthest_m)) continue;
    out.moved.push_back(p);
    out.ring.push_back(ring);
    const std::size_t column = transposed ? i / cloud.width : i % cloud.width;
    out.column.push_back(out.columns != 0 ? static_cast<std::uint32_t>(column) : kNoColumn);
  }
  return out;
}

ScanSample thin(const ScanSample& sample, std::size_t rings, std::size_t limit) {
  std::vector<std::size_t> count(rings, 0), seen(rings, 0);
  for (const std::uint16_t ring : sample.ring) ++count[ring];
  const std::size_t share = std::max<std::size_t>(32, limit / std::max<std::size_t>(1, rings));
  ScanSample out;
  out.columns = sample.columns;
  out.motion = sample.motion;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const std::size_t ring = sample.ring[i];
    const std::size_t k = seen[ring]++;
    const std::size_t wanted = std::min(share, count[ring]);
    // The k-th of `count` is kept where the count of kept ones goes up.
    if ((k + 1) * wanted / count[ring] != k * wanted / count[ring]) append(out, sample, i);
  }
  return out;
}

Vec3 undo(const MotionTwist& motion, const Vec3& moved) {
  return motion.none() ? moved : undo_motion(motion, moved).point;
}

Vec3 point_by_turn(const MotionTwist& motion, const Vec3& point, double s) {
  return (cross(motion.turn, point) + rotate(motion.turn * -s, motion.move)) * -1;
}

double wrapped(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

}  // namespace curlidar::calibration
