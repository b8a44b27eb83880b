// SPDX-License-Identifier: BSD-3-Clause
// What sensor made a scan: its rings, columns, limits; built-in, from a file, or detected.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// One laser (channel) of a spinning LiDAR. Angles in radians.
struct Ring {
  double elevation = 0;       ///< of the beam, above the horizontal
  double azimuth_offset = 0;  ///< of the beam against the encoder angle, counter-clockwise
  double vertical_offset_m = 0;    ///< height of the beam's origin above the sensor origin
  double horizontal_offset_m = 0;  ///< sideways displacement of the beam's origin
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

  /// Elevations of the rings, top to bottom, radians.
  std::vector<double> elevations() const;
};

/// Checks what every consumer relies on: 1..1024 rings strictly descending in elevation, finite
/// angles inside +-90 degrees, 4..65536 columns, fov_up > fov_down (equal allowed for one ring),
/// 0 <= min_range < max_range.
Status validate(const SensorProfile& profile);

/// Names of the built-in profiles, sorted.
std::vector<std::string> builtin_sensor_names();
/// A built-in profile. Unknown names: not_found, with the nearest names in the message.
Result<SensorProfile> builtin_sensor(std::string_view name);

/// TOML text of a profile, readable by parse_sensor_toml.
std::string sensor_to_toml(const SensorProfile& profile);
/// `where` names the source in messages.
Result<SensorProfile> parse_sensor_toml(std::string_view text, const std::string& where);
/// Ouster metadata JSON (both the flat and the nested layouts).
Result<SensorProfile> parse_ouster_metadata(std::string_view text, const std::string& where);
/// A built-in name, or the path of a .toml or Ouster .json file.
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
  std::size_t points = 0;        ///< slots of the cloud
  std::size_t returns = 0;       ///< finite, not (0,0,0)
  std::size_t not_finite = 0;    ///< NaN or infinite slots
  std::size_t zero = 0;          ///< (0,0,0) slots
  double azimuth_coverage = 0;   ///< share of 1-degree sectors with a return
  double range_min_m = 0, range_p50_m = 0, range_p90_m = 0, range_max_m = 0;
  double elevation_min = 0, elevation_max = 0;
  /// Nominal occupancy: returns / (rings * columns), at most 1.
  double occupancy = 0;
  std::vector<std::string> notes;  ///< what a user should know, one sentence each
};

/// Finds rings, columns and limits of a scan: `--sensor auto`. Zero points and NaN are skipped
/// first. Clouds without a return: invalid_argument. Limited-field scanners (azimuth coverage
/// far from a full turn *and* no ring structure) are named so in `notes` and in the pattern.
/// O(n log n).
Result<Detection> detect_sensor(const Cloud& cloud);

/// The same report for a given profile: every return goes to the ring nearest in elevation.
Result<Detection> assign_rings(const Cloud& cloud, const SensorProfile& profile);

}  // namespace curlidar
