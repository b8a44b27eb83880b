// SPDX-License-Identifier: BSD-3-Clause
// The lattice of encoder positions that azimuths lie on, before anything about it is known.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sensor/calibrate_sample.hpp"

namespace curlidar::calibration {

/// How many encoder positions a turn may have: those of sensors known to us and the hints.
std::vector<std::uint32_t> slot_candidates(std::span<const std::uint32_t> hints);

/// An encoder that explains the azimuths of a scan.
struct Encoder {
  std::uint32_t slots = 0;
  double yaw = 0;        ///< turn.z of the motion of the scan that was searched
  double resultant = 0;  ///< mean over probed beams: 1 all on the lattice, about 0.15 by chance
};

/// The coarsest encoder that explains the azimuths of one scan, whose cones and motion but for the
/// yaw are known. The yaw is searched for only if `search_yaw`. Nothing if none does.
std::optional<Encoder> find_encoder(const ScanSample& sample, std::size_t rings,
                                    std::span<const std::uint32_t> candidates, bool search_yaw);

/// The yaw of another scan of the same sensor, whose beams are known.
std::optional<Encoder> find_yaw(const ScanSample& sample, const BeamModel& model);

/// Lateral offset and azimuth offset (within half a pitch of 0) of every beam by the best
/// resultant over a scan whose motion is known. Beams with too few returns keep theirs.
void start_azimuths(const ScanSample& sample, BeamModel& model);

}  // namespace curlidar::calibration
