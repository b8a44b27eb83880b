// SPDX-License-Identifier: BSD-3-Clause
// The rays of sensors: from what is known of them to the integers of a file.
#pragma once

#include <optional>

#include "compact/scan_types.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/field.hpp"
#include "sensor/lattice.hpp"

namespace curlidar {

/// The lattice of a scan by the tables of the format, the given sensor, or the built-in profiles
/// that know their encoder; nothing if it fits none.
Result<std::optional<LatticeFit>> find_sensor_lattice(const Cloud& cloud, const Detection& rings,
                                                      const EncodeSettings& settings);

/// The rows of a lattice in integers, rounded so that an error of `error_m` (metres; 0: as exactly
/// as can be) does not show it.
compact::RowTable ray_rows(const LatticeFit& fit, double error_m);

/// What its ranges are multiples of, 2^-48 m; 0: not known.
std::uint64_t range_unit_of(const LatticeFit& fit);

/// What the motion of a scan does to points at an azimuth (radians) of the sensor's own frame.
RigidMotion rigid_motion(const compact::Motion& motion, double azimuth);

}  // namespace curlidar
