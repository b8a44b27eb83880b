// SPDX-License-Identifier: BSD-3-Clause
// A LiDAR simulator with exact ground truth at any density.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/lattice.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"

namespace curlidar {

/// What a ray met.
struct Hit {
  double range_m = 0;        ///< along the unit direction
  double reflectivity = 0;   ///< of the surface, [0, 1]
  double cos_incidence = 0;  ///< |cos| of the angle to the surface normal
  bool moving = false;       ///< belongs to a thing that moves (curlidar/drive.hpp)
};

/// An analytic world around the sensor, which stands at the origin of its own frame.
class Scene {
 public:
  virtual ~Scene() = default;
  /// First surface from `origin` along the unit vector `direction`, exact to double rounding.
  /// False if there is none (sky).
  virtual bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const = 0;
};

/// "street", "room", "forest", "corridor", "newer-college".
std::vector<std::string> scene_names();
/// The seed places trees, cars, furniture; the same seed gives the same world everywhere.
Result<std::shared_ptr<const Scene>> make_scene(std::string_view name, std::uint64_t seed = 1);

struct SimulateSettings {
  double range_noise_m = 0.01;  ///< standard deviation along the beam
  double dropout = 0.02;        ///< share of returns lost at random
  double range_unit_m = 0;      ///< ranges are rounded to multiples; 0 = none
  /// Off: all beams leave from the sensor's origin. On: from the profile's beam origins, at
  /// beam_origin_radius_m along the encoder's angle, vertical_offset_m up and horizontal_offset_m
  /// to the left of the beam; range limits, noise and rounding then apply to the distance from
  /// the beam's origin plus beam_origin_radius_m, as Ouster's sensors count it.
  bool beam_origins = false;
  bool mark_moving = false;      ///< adds the attribute moving (uint8): 1 on things that move
  double turns_per_second = 10;  ///< of the time attribute; the sensor does not move
  std::uint64_t seed = 1;
  std::size_t threads = 1;  ///< never changes the result
};

/// One turn of the sensor: unorganised, ring by ring from the top, with attributes intensity
/// (float32, 0..1), ring (uint16) and time (float32 seconds from the start of the turn).
/// Beam `column` of a ring looks along the encoder's angle -pi + 2 pi column / columns plus the
/// ring's azimuth_offset. Intensity = reflectivity * cos(incidence). Coordinates are rounded to
/// float32, as drivers store them. Measured ranges outside the sensor's limits give no return.
/// Errors: invalid_argument for a bad profile or setting. About 1 us a beam.
Result<Cloud> simulate(const Scene& scene, const SensorProfile& sensor,
                       const SimulateSettings& settings = {});

/// The exact cloud, without noise or dropouts, at the directions of `lattice` made
/// row_factor x column_factor denser (fractional allowed), as `reconstruct` lays its grid.
/// Organised, float64, with attribute intensity; NaN where the ray meets nothing or its range
/// leaves [min_range, max_range]. Errors: invalid_argument; limit_exceeded beyond 2^31 points.
Result<Cloud> simulate_truth(const Scene& scene, const Lattice& lattice, double row_factor,
                             double column_factor, double min_range_m, double max_range_m,
                             std::size_t threads = 1);

}  // namespace curlidar
