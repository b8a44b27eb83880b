// SPDX-License-Identifier: BSD-3-Clause
// The sensor chunk: the profile of the sensor that made the scan.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"
#include "format/container.hpp"

namespace curlidar {

inline constexpr std::size_t kMaxSensorNameBytes = 255;
inline constexpr std::size_t kMaxSensorDescriptionBytes = 4096;

/// The payload for a profile, every number exactly as it is. invalid_argument if the profile is
/// not valid or a text is too long or not UTF-8.
Result<std::vector<std::byte>> write_sensor(const SensorProfile& profile);
/// The profile of a payload, validated.
Result<SensorProfile> read_sensor(const Chunk& chunk);

}  // namespace curlidar
