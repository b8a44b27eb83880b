// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/own_scan.hpp"

#include <utility>

#include "base/try.hpp"
#include "codec/beam_tables.hpp"
#include "sensor/own_frame.hpp"

namespace curlidar::bench {

Result<OwnScan> own_scan(const Scan& scan) {
  OwnScan own;
  CURLIDAR_TRY_ASSIGN(rings, scan.settings.sensor ? assign_rings(scan.cloud, *scan.settings.sensor)
                                                  : detect_sensor(scan.cloud));
  std::optional<LatticeFit> lattice;
  if (rings.source != RingSource::uniform) {  // else there are no rings to look for
    CURLIDAR_TRY_ASSIGN(found, find_sensor_lattice(scan.cloud, rings, scan.settings));
    lattice = std::move(found);
  }
  own.motion_undone = lattice && !lattice->motion.none();
  own.cloud = own.motion_undone ? in_own_frame(scan.cloud, *lattice) : scan.cloud;
  own.rings = std::move(rings);
  own.lattice = std::move(lattice);
  return own;
}

const BeamModel* beams_of(const OwnScan& own) {
  const bool known =
      own.lattice && own.lattice->beams.beams.size() == own.rings.sensor.rings.size();
  return known ? &own.lattice->beams : nullptr;
}

}  // namespace curlidar::bench
