// SPDX-License-Identifier: BSD-3-Clause
// A short simulated drive, coded at little effort.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "curlidar/motion.hpp"
#include "curlidar/sequence.hpp"
#include "support/scans.hpp"

namespace curlidar::test {

/// A scene as it is seen from another place, not turned.
class SceneFrom : public Scene {
 public:
  SceneFrom(std::shared_ptr<const Scene> scene, const Vec3& place)
      : scene_(std::move(scene)), place_(place) {}
  bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const override {
    return scene_->cast(origin + place_, direction, hit);
  }

 private:
  std::shared_ptr<const Scene> scene_;
  Vec3 place_;
};

/// A street seen by the given sensor from some metres along it.
inline Cloud scan_of(const SensorProfile& sensor, double along_m = 0, std::uint64_t seed = 1) {
  SimulateSettings settings;
  settings.seed = seed;
  const SceneFrom scene(make_scene("street").value(), {along_m, 0, 0});
  return simulate(scene, sensor, settings).value();
}

/// Half a metre from scan to scan.
inline std::vector<Cloud> drive(std::size_t scans, double step_m = 0.5) {
  std::vector<Cloud> clouds;
  for (std::size_t i = 0; i < scans; ++i) {
    clouds.push_back(scan_of(small_sensor(16, 192), step_m * static_cast<double>(i), i + 1));
  }
  return clouds;
}

/// Geometry only, quickly.
inline SequenceSettings drive_settings(std::uint32_t group) {
  SequenceSettings settings;
  settings.encode.sensor = small_sensor(16, 192);
  settings.encode.attributes.emplace();
  settings.encode.compact.target = CompactTarget::step;
  settings.encode.compact.target_value = 0.2;
  settings.encode.compact.effort = 1;
  settings.group = group;
  return settings;
}

/// Poses all over the place.
inline RigidMotion some_pose(int number) {
  const double yaw = 0.37 * number, pitch = 0.11 * number - 1, roll = 2.9 * std::sin(number);
  const double cy = std::cos(yaw), sy = std::sin(yaw), cp = std::cos(pitch), sp = std::sin(pitch);
  const double cr = std::cos(roll), sr = std::sin(roll);
  RigidMotion pose;
  pose.rotation = {{{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr},
                    {sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr},
                    {-sp, cp * sr, cp * cr}}};
  pose.move = {431256.25 + 1.375 * number, -5812345.5 + number, 120.0625 - number / 3.0};
  return pose;
}

}  // namespace curlidar::test
