// SPDX-License-Identifier: BSD-3-Clause
#include "dense/motion_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curlidar {
namespace {

// Between nodes motions are taken to be linear. A scan turns .2 rad at most, 1e-4 rad from node to
// node: that misses by 1e-9 of the distance.
constexpr std::size_t kSteps = 2048;
constexpr double kPi = std::numbers::pi;

Vec3 mix(const Vec3& a, const Vec3& b, double share) {
  return a + (b - a) * share;
}

}  // namespace

MotionTable::MotionTable(const Field& field) {
  if (!field.moves()) return;
  nodes_.reserve(kSteps + 1);
  for (std::size_t i = 0; i <= kSteps; ++i) {
    nodes_.push_back(field.motion_at(kPi * (2 * static_cast<double>(i) / kSteps - 1)));
  }
}

RigidMotion MotionTable::at(double azimuth) const {
  const double place = std::fmin(std::fmax((azimuth / kPi + 1) / 2, 0.0), 1.0) * kSteps;
  const auto node = std::min(static_cast<std::size_t>(place), kSteps - 1);
  const double share = place - static_cast<double>(node);
  const RigidMotion &a = nodes_[node], &b = nodes_[node + 1];
  RigidMotion motion;
  for (std::size_t i = 0; i < 3; ++i) {
    motion.rotation[i] = mix(a.rotation[i], b.rotation[i], share);
  }
  motion.move = mix(a.move, b.move, share);
  return motion;
}

}  // namespace curlidar
