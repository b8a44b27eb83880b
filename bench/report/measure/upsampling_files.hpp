// SPDX-License-Identifier: BSD-3-Clause
// What a user has of a sensor of 16 rings: a file of its rings, decoded as the sensor of 64 rings
// would see it.
#pragma once

#include <memory>

#include "curlidar/codec.hpp"
#include "curlidar/dense.hpp"
#include "protocol/tulip_image.hpp"

namespace curlidar::bench {

struct RingFile {
  DecodedScan scan;
  double bits_per_point = 0;
};

/// The returns of the rings 0, 4, .. 60 of a scan in the sensor's own frame, coded as those of a
/// sensor with these rings.
Result<RingFile> file_of_rings(const Cloud& own, const Detection& rings, CompactTarget target,
                               double value);

/// The image of the file's points as the whole sensor sees them (curlidar decode --sensor).
Result<tulip::Image> seen_by(const RingFile& file, const SensorProfile& sensor,
                             std::shared_ptr<const DensityProfile> profile);

}  // namespace curlidar::bench
