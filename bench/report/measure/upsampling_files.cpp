// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/upsampling_files.hpp"

#include <utility>

#include "base/try.hpp"
#include "curlidar/reconstruct.hpp"
#include "protocol/ring_split.hpp"
#include "report/measure/codecs.hpp"

namespace curlidar::bench {

Result<RingFile> file_of_rings(const Cloud& own, const Detection& rings, CompactTarget target,
                               double value) {
  const RingSplit split = split_rings(own, rings, tulip::kEvery);
  EncodeSettings settings = compact_of_scan(target, value);
  settings.sensor = split.sensor;
  CURLIDAR_TRY_ASSIGN(encoded, encode(split.coded, settings));
  CURLIDAR_TRY_ASSIGN(decoded, decode(encoded.bytes));
  return RingFile{std::move(decoded), encoded.report.bits_per_point};
}

Result<tulip::Image> seen_by(const RingFile& file, const SensorProfile& sensor,
                             std::shared_ptr<const DensityProfile> profile) {
  ReconstructSettings settings;
  settings.density_profile = std::move(profile);
  CURLIDAR_TRY_ASSIGN(cloud, reconstruct_sensor(file.scan, sensor, settings));
  return tulip::project(cloud);
}

}  // namespace curlidar::bench
