// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/drive.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/try.hpp"
#include "simulate/block.hpp"
#include "simulate/random.hpp"

namespace curlidar {

namespace {

constexpr std::size_t kMaxScans = 1'000'000;
constexpr double kSensorHeight = 1.79;  // above the ground, under 6 cm of road
constexpr double kLane = -1.7;          // of the car, to the right of the street's middle
constexpr double kSway = 0.25;          // metres within its lane
constexpr double kStillScansPerSecond = 10;
constexpr double kReach = 130;  // movers farther away are left out

/// A world seen from a pose, with what moves or without.
class SceneFromPose final : public Scene {
 public:
  SceneFromPose(const Scene& still, const Scene* moving, const RigidMotion& T_map_sensor)
      : still_(still), moving_(moving), pose_(T_map_sensor) {}

  bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const override {
    const Vec3 from = pose_(origin), along = pose_.turned(direction);
    Hit other;
    const bool found = still_.cast(from, along, hit);
    const bool moves = moving_ != nullptr && moving_->cast(from, along, other);
    if (moves && (!found || other.range_m < hit.range_m)) {
      hit = other;
      hit.moving = true;
    }
    return found || moves;
  }

 private:
  const Scene& still_;
  const Scene* moving_;
  RigidMotion pose_;
};

RigidMotion turned_about(double yaw, double pitch, double roll) {
  const double cy = std::cos(yaw), sy = std::sin(yaw), cp = std::cos(pitch), sp = std::sin(pitch);
  const double cr = std::cos(roll), sr = std::sin(roll);
  RigidMotion motion;
  motion.rotation = {{{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr},
                      {sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr},
                      {-sp, cp * sr, cp * cr}}};
  return motion;
}

Status check(const DriveSettings& settings) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (settings.scans == 0 || settings.scans > kMaxScans) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("drive: {} scans; give 1 to {}", settings.scans, kMaxScans)};
  }
  if (!(settings.laps >= 0 && settings.laps <= 1e6) || !positive(settings.step_m) ||
      settings.step_m > 1e3 || !positive(settings.speed_mps)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("drive: {} laps, a scan every {} m, {} m/s; give laps of 0 "
                             "to a million, steps of up to 1000 m and a speed above 0",
                             settings.laps, settings.step_m, settings.speed_mps)};
  }
  return {};
}

}  // namespace

struct Drive::State {
  DriveSettings settings;
  std::unique_ptr<const Scene> block;

  double along(std::size_t scan) const {
    if (settings.still) return 0;
    const auto n = static_cast<double>(scan);
    return settings.laps > 0
               ? n * settings.laps * scenery::block_lap_m() / static_cast<double>(settings.scans)
               : n * settings.step_m;
  }
  /// Each scan has noise of its own.
  SimulateSettings settings_of(std::size_t scan, SimulateSettings simulate) const {
    simulate.seed = scenery::keyed_bits(settings.seed, scan, simulate.seed, 5);
    return simulate;
  }
};

Drive::Drive(std::unique_ptr<State> state) : state_(std::move(state)) {}
Drive::~Drive() = default;
Drive::Drive(Drive&&) noexcept = default;
Drive& Drive::operator=(Drive&&) noexcept = default;

Result<Drive> Drive::make(const DriveSettings& settings) {
  CURLIDAR_TRY(check(settings));
  auto state = std::make_unique<State>();
  state->settings = settings;
  scenery::Sketch sketch;
  scenery::draw_block(sketch, settings.seed);
  state->block = std::make_unique<scenery::World>(std::move(sketch));
  return Drive(std::move(state));
}

std::size_t Drive::scans() const {
  return state_->settings.scans;
}
double Drive::lap_m() const {
  return scenery::block_lap_m();
}
double Drive::time_s(std::size_t scan) const {
  return state_->settings.still ? static_cast<double>(scan) / kStillScansPerSecond
                                : state_->along(scan) / state_->settings.speed_mps;
}

RigidMotion Drive::T_map_sensor(std::size_t scan) const {
  // The car sways a little, not in time with laps, so that no two laps have the same poses.
  const double s = state_->along(scan);
  const double sway = kSway * std::sin(s / 13.7);
  const scenery::StreetPlace place = scenery::block_street(s, kLane + sway);
  const double drift = kSway / 13.7 * std::cos(s / 13.7);
  RigidMotion pose =
      turned_about(place.yaw + drift, 0.006 * std::sin(s / 4.3), 0.004 * std::sin(s / 3.1));
  pose.move = place.position + Vec3{0, 0, kSensorHeight + 0.01 * std::sin(s / 2.3)};
  return pose;
}

Result<Cloud> Drive::scan(std::size_t scan, const SensorProfile& sensor,
                          const SimulateSettings& settings) const {
  const RigidMotion pose = T_map_sensor(scan);
  scenery::Sketch sketch;
  if (state_->settings.traffic) {
    scenery::draw_traffic(sketch, state_->settings.seed, time_s(scan), pose.move, kReach);
  }
  const bool moves = !sketch.primitives.empty();
  const scenery::World traffic(std::move(sketch));
  const SceneFromPose scene(*state_->block, moves ? &traffic : nullptr, pose);
  return simulate(scene, sensor, state_->settings_of(scan, settings));
}

Result<Cloud> Drive::truth(std::size_t scan, const SensorProfile& sensor,
                           const SimulateSettings& settings) const {
  const RigidMotion pose = T_map_sensor(scan);
  const SceneFromPose scene(*state_->block, nullptr, pose);
  SimulateSettings exact = settings;
  exact.range_noise_m = exact.range_unit_m = exact.dropout = 0;
  CURLIDAR_TRY_ASSIGN(cloud, simulate(scene, sensor, exact));
  for (Vec3& p : cloud.positions) p = pose(p);
  cloud.position_type = ScalarType::float64;
  cloud.metadata["source"] = "simulated, exact";
  return cloud;
}

}  // namespace curlidar
