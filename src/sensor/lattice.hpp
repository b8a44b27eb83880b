// SPDX-License-Identifier: BSD-3-Clause
// The exact lattice of a scan: at which encoder position and along which beam each return was
// measured. Drivers compute points from integers (laser, encoder position, range); here the way
// back is found, motion compensation included. Encoder side, in doubles.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"
#include "sensor/motion.hpp"

namespace curlidar {

/// One laser, in the terms of compact::Ray. At encoder angle t it looks along a = t +
/// azimuth_offset; the point at range r is, with u = (r + range_phase_m) cos(elevation),
///   (u cos a - lateral_m sin a, u sin a + lateral_m cos a,
///    (r + range_phase_m) sin(elevation) + height_m).
struct Beam {
  double elevation = 0;       ///< radians
  double azimuth_offset = 0;  ///< radians
  double height_m = 0, lateral_m = 0, range_phase_m = 0;

  friend bool operator==(const Beam&, const Beam&) = default;
};

/// A sensor whose rays are known well enough for an exact lattice.
struct BeamModel {
  std::string table;        ///< name of the format's frozen table that this is; empty: none
  std::vector<Beam> beams;  ///< top to bottom, as the rings of a profile
  /// Encoder positions of a turn. Position n is encoder angle -pi + 2 pi n / slots.
  std::uint32_t slots = 0;
  double range_unit_m = 0;  ///< ranges are multiples of it; 0: no unit known

  friend bool operator==(const BeamModel&, const BeamModel&) = default;
};

/// The rays of a profile that says how many `slots` a turn has, in the terms above (an Ouster's
/// beam origins become lateral, height and phase); nothing for other profiles.
std::optional<BeamModel> beam_model_of(const SensorProfile& profile);

/// beam_model_of() of the built-in profiles that have one, by name. Read once.
std::span<const BeamModel> builtin_beam_models();

inline constexpr std::uint32_t kNoFiring = 0xffffffff;

struct LatticeSettings {
  bool motion = true;          ///< whether to look for motion compensation
  double tolerance_m = .0015;  ///< a return counts as on the lattice within this of its place
  double reach_m = .004;       ///< a return within this of a free place is still put there
  double min_share = .8;       ///< returns that must lie on the lattice for it to be accepted
  /// Cells (rings x firings) that must hold a return. Where lasers of one column have positions of
  /// their own, as a VLP-16's do, hardly any do, and the lattice is no help.
  double min_occupancy = .1;
};

/// Distances of the returns on the lattice from their places on it, metres.
struct LatticeResiduals {
  double across_median_m = 0, across_p95_m = 0;  ///< along the row
  double up_median_m = 0, up_p95_m = 0;          ///< out of the beam's cone
  /// Of the ranges from multiples of the range unit; 0 if there is no unit.
  double range_median_m = 0, range_p95_m = 0;
};

/// The lattice found in a scan. Vectors are indexed by the slots of the cloud.
struct LatticeFit {
  BeamModel beams;
  MotionTwist motion;
  std::vector<std::uint32_t> firings;          ///< encoder positions with a return, ascending
  std::vector<std::uint16_t> ring_of_point;    ///< kNoRing: no return, or its beam is not known
  std::vector<std::uint32_t> firing_of_point;  ///< index into `firings`; kNoFiring: off the lattice
  std::vector<double> range_of_point;          ///< r along the ray (phase taken off), metres
  /// Returns whose place is theirs alone; the others have kNoFiring.
  std::size_t placed = 0, returns = 0;
  /// Returns without a place that lie along a ray which another return has: second returns.
  std::size_t sharing = 0;
  double share = 0;  ///< of the returns that lie within the tolerance of a ray
  LatticeResiduals residuals;
  std::vector<std::string> notes;  ///< what a user should know, one sentence each
};

/// Finds the lattice of a scan whose rings are known about right, by trying the candidates with as
/// many beams as `rings` has, and undoing the motion compensation if there is any. The best
/// candidate wins; nothing if less than min_share of the returns lie on any.
/// Errors: invalid_argument (`rings` is not of this cloud). O(n), plus the search for the motion
/// on a sample of the returns. Deterministic.
Result<std::optional<LatticeFit>> find_lattice(const Cloud& cloud, const Detection& rings,
                                               std::span<const BeamModel> candidates,
                                               const LatticeSettings& settings = {});

/// The point at range r of a beam and an encoder position, before motion.
Vec3 lattice_point(const BeamModel& model, std::size_t ring, std::uint32_t position, double range);

/// A point of the sensor's own frame as one beam would have seen it.
struct BeamView {
  double range = 0;       ///< r, metres, phase taken off
  double up_m = 0;        ///< distance from the beam's cone, upwards
  double encoder = 0;     ///< encoder angle, radians in [-pi, pi)
  double distance_m = 0;  ///< horizontal, from the spin axis: a radian of encoder in metres
};
/// Points nearer to the spin axis than the beam's lateral offset: nothing.
std::optional<BeamView> view_along(const Beam& beam, const Vec3& point);

}  // namespace curlidar
