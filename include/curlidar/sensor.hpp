// SPDX-License-Identifier: BSD-3-Clause
// What sensor made a scan: its rings, columns, limits; built-in, from a file, or detected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

inline constexpr std::size_t kMaxRings = 1024;
inline constexpr std::uint32_t kMaxSlots = 1u << 22;

/// One laser (channel) of a spinning LiDAR. Angles in radians.
struct Ring {
  double elevation = 0;            ///< of the beam, above the horizontal
  double azimuth_offset = 0;       ///< of the beam against the encoder angle, counter-clockwise
  double vertical_offset_m = 0;    ///< height where the beam's line meets the spin axis
  double horizontal_offset_m = 0;  ///< displacement of the beam's origin to the left
  double range_phase_m = 0;        ///< added to a multiple of the range unit, along the beam
};

/// Whether the profile describes a 360 degree spinning sensor.
enum class ScanPattern { spinning, limited_field };

/// A sensor model. Rings run from the top beam (largest elevation) to the bottom one.
struct SensorProfile {
  std::string name;         ///< "hdl64e-kitti", "vlp16", ...; "auto" when detected
  std::string description;  ///< one line for people
  ScanPattern pattern = ScanPattern::spinning;
  std::vector<Ring> rings;
  std::uint32_t columns = 1024;  ///< firings in a turn, nominal
  double fov_up = 0;             ///< nominal vertical field of view, upper edge
  double fov_down = 0;           ///< lower edge, below fov_up
  double min_range_m = 0;
  double max_range_m = 120;
  double beam_origin_radius_m = 0;  ///< Ouster's lidar_origin_to_beam_origin
  /// Encoder positions of a turn, at angles -pi + 2 pi n / slots; 0: not known. With it the offsets
  /// of the rings are taken as exact, and points are placed on the sensor's own lattice.
  std::uint32_t slots = 0;
  double range_unit_m = 0;  ///< ranges are multiples of it; 0: not known

  /// Elevations of the rings, top to bottom, radians.
  std::vector<double> elevations() const;
  /// Elevation at which the sensor's origin sees a return of ring `ring` that lies `distance_m`
  /// (> 0) away from the spin axis: beams do not start at the origin (HDL-64E: 1.2 degrees at
  /// 10 m).
  double apparent_elevation(std::size_t ring, double distance_m) const;
};

/// Checks what every consumer relies on: 1..kMaxRings rings strictly descending in elevation,
/// finite angles inside +-90 degrees, beam origins within 10 m, 4..65536 columns, fov_up > fov_down
/// (equal allowed for one ring), 0 <= min_range < max_range, at most kMaxSlots slots, a range unit
/// and phases below 10 m.
Status validate(const SensorProfile& profile);

/// Names of the built-in profiles, sorted.
std::vector<std::string> builtin_sensor_names();
/// A built-in profile; case, '-' and '_' do not matter, and usual short names ("xt16") are known.
/// Unknown names: not_found, with the nearest names in the message. Limited-field scanners (Livox,
/// AT128, flash): unsupported.
Result<SensorProfile> builtin_sensor(std::string_view name);

/// TOML text of a valid profile; parse_sensor_toml gives back exactly the same numbers. Angles are
/// in degrees, or in radians (keys ending in _rad) where no decimal number of degrees is exact.
std::string sensor_to_toml(const SensorProfile& profile);
/// The format is described in docs/sensors.md. `where` names the source in messages, which give
/// the line. Errors: corrupt (not TOML), invalid_argument (unknown key, wrong type, bad value).
Result<SensorProfile> parse_sensor_toml(std::string_view text, const std::string& where);
/// Ouster metadata JSON (both the flat and the nested layouts). Beams become rings, top to bottom;
/// columns come from the lidar mode. Errors: corrupt (not JSON), invalid_argument, unsupported.
Result<SensorProfile> parse_ouster_metadata(std::string_view text, const std::string& where);
/// A built-in name, or the path of a .toml or Ouster .json file (at most 4 MiB).
Result<SensorProfile> load_sensor(const std::string& name_or_path);

/// How the ring of each point was found.
enum class RingSource {
  ring_attribute,  ///< a ring/channel/laser_id attribute of the cloud
  organised_rows,  ///< rows of an organised cloud
  azimuth_wraps,   ///< ring by ring file order, as KITTI
  clustered,       ///< clusters of elevation
  profile,         ///< nearest ring of a given profile
  uniform,         ///< no rings found: uniform rows over the observed field of view
};
const char* to_string(RingSource source);

inline constexpr std::uint16_t kNoRing = 0xffff;

/// What `detect_sensor` found.
struct Detection {
  SensorProfile sensor;  ///< a built-in one if it matches, else named "auto"
  RingSource source = RingSource::uniform;
  /// Ring of every point of the cloud (index into sensor.rings), kNoRing where there is no return.
  std::vector<std::uint16_t> ring_of_point;
  /// Median elevation of each ring's returns as seen from the sensor's origin (radians), strictly
  /// descending; rings without a return have their nominal place. Where beams start away from the
  /// origin these are the rows of an image of *this* scan, sensor.elevations() are not.
  std::vector<double> ring_elevations;
  std::size_t points = 0;       ///< slots of the cloud
  std::size_t returns = 0;      ///< finite, not (0,0,0)
  std::size_t not_finite = 0;   ///< NaN or infinite slots
  std::size_t zero = 0;         ///< (0,0,0) slots
  double azimuth_coverage = 0;  ///< share of 1-degree sectors with a return
  double range_min_m = 0, range_p50_m = 0, range_p90_m = 0, range_max_m = 0;
  double elevation_min = 0, elevation_max = 0;
  /// Nominal occupancy: returns / (rings * columns), at most 1.
  double occupancy = 0;
  std::vector<std::string> notes;  ///< what a user should know, one sentence each
};

/// Finds rings, columns and limits of a scan: `--sensor auto`. Zero points and NaN are skipped
/// first. Rings come, in this order, from an attribute (ring, channel, laser_id, laser, line), the
/// rows (or columns) of an organised cloud, file order ring by ring, a built-in sensor whose beams
/// fit the elevations, clusters of elevation; else the sensor gets uniform rows over the observed
/// field of view. Attributes, rows and file order count only if each holds one cone of beams.
/// Range limits are widened to what the scan holds. Clouds without a return: invalid_argument.
/// Limited-field scanners (azimuth coverage far from a full turn *and* no ring structure) are named
/// so in `notes` and in the pattern. O(n log n).
Result<Detection> detect_sensor(const Cloud& cloud);

/// The same report for a given profile: every return goes to the ring nearest in elevation, the
/// places of the beams' origins taken into account. Errors: invalid_argument (a profile that
/// validate() refuses, no return). O(n log rings).
Result<Detection> assign_rings(const Cloud& cloud, const SensorProfile& profile);

}  // namespace curlidar
