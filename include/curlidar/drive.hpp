// SPDX-License-Identifier: BSD-3-Clause
// A simulated drive: scans with exact poses, through streets whose surface is known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "curlidar/cloud.hpp"
#include "curlidar/motion.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"
#include "curlidar/simulate.hpp"

namespace curlidar {

struct DriveSettings {
  std::size_t scans = 100;
  double laps = 0;        ///< around the block, the scans evenly spread; 0: one scan every `step_m`
  double step_m = 1;      ///< between scans
  bool still = false;     ///< the sensor stays where the drive begins; others still move
  bool traffic = true;    ///< cars and walkers that move
  double speed_mps = 10;  ///< of the car; a sensor that stands takes ten scans a second
  std::uint64_t seed = 1;
};

/// A car with a sensor on its roof drives around a block of houses: a closed street of some 360 m
/// on uneven ground, with parked cars, trees, fences and lamps, among cars and walkers that move.
/// Every scan is taken at one moment. The same settings give the same drive on every thread count.
class Drive {
 public:
  /// Errors: invalid_argument (no scans, more than a million, a length that makes no sense).
  static Result<Drive> make(const DriveSettings& settings);
  ~Drive();
  Drive(Drive&&) noexcept;
  Drive& operator=(Drive&&) noexcept;

  std::size_t scans() const;
  double lap_m() const;  ///< length of the street's middle
  /// Where the sensor is during a scan below scans(): from its frame (x ahead) to the map's.
  RigidMotion T_map_sensor(std::size_t scan) const;
  double time_s(std::size_t scan) const;

  /// What the sensor measures, in its own frame, as simulate(). Noise differs from scan to scan;
  /// SimulateSettings::mark_moving tells what moves.
  Result<Cloud> scan(std::size_t scan, const SensorProfile& sensor,
                     const SimulateSettings& settings = {}) const;
  /// The exact surface of what stands still along the same beams, things that move taken away, in
  /// the map's frame, float64. Beams that meet nothing within the sensor's limits are left out.
  Result<Cloud> truth(std::size_t scan, const SensorProfile& sensor,
                      const SimulateSettings& settings = {}) const;

 private:
  struct State;
  explicit Drive(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace curlidar
