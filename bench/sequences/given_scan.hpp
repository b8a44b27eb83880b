// SPDX-License-Identifier: BSD-3-Clause
// Scans by name: files, and simulated ones as "sim:SCENE:SENSOR:NUMBER:X_M:YAW_DEG", the sensor
// moved by X_M and turned by YAW_DEG; the number only changes noise and dropouts.
#pragma once

#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "curlidar/io.hpp"
#include "curlidar/sensor.hpp"
#include "curlidar/simulate.hpp"

namespace curlidar::bench {

/// A scene seen from elsewhere.
class MovedScene : public Scene {
 public:
  MovedScene(std::shared_ptr<const Scene> scene, double x_m, double yaw)
      : scene_(std::move(scene)), x_m_(x_m), cos_(std::cos(yaw)), sin_(std::sin(yaw)) {}

  bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const override {
    return scene_->cast(turned(origin) + Vec3{x_m_, 0, 0}, turned(direction), hit);
  }

 private:
  Vec3 turned(const Vec3& p) const {
    return {cos_ * p.x - sin_ * p.y, sin_ * p.x + cos_ * p.y, p.z};
  }

  std::shared_ptr<const Scene> scene_;
  double x_m_, cos_, sin_;
};

inline Result<Cloud> given_scan(const std::string& name) {
  if (name.rfind("sim:", 0) != 0) return read_cloud(name);
  std::vector<std::string> words;
  std::istringstream text(name);
  for (std::string word; std::getline(text, word, ':');) words.push_back(word);
  if (words.size() != 6) {
    return Error{ErrorCode::invalid_argument, "sim:SCENE:SENSOR:NUMBER:X_M:YAW_DEG, not " + name};
  }
  auto scene = make_scene(words[1]);
  if (!scene) return scene.error();
  const auto sensor = builtin_sensor(words[2]);
  if (!sensor) return sensor.error();
  SimulateSettings settings;
  settings.seed = std::stoull(words[3]);
  return simulate(
      MovedScene(*scene, std::stod(words[4]), std::stod(words[5]) * std::numbers::pi / 180),
      *sensor, settings);
}

}  // namespace curlidar::bench
