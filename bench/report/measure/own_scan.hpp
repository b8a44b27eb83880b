// SPDX-License-Identifier: BSD-3-Clause
// A scan as its sensor saw it, motion undone.
#pragma once

#include <optional>

#include "report/measure/inputs.hpp"
#include "sensor/lattice.hpp"

namespace curlidar::bench {

struct OwnScan {
  Cloud cloud;
  Detection rings;
  std::optional<LatticeFit> lattice;  ///< of the scan; nothing if it has none that is known
  bool motion_undone = false;
};

/// The scan in its sensor's own frame; as it is where its motion cannot be told.
Result<OwnScan> own_scan(const Scan& scan);

/// The beams of the scan's rings, as far as they are known; else nullptr.
const BeamModel* beams_of(const OwnScan& own);

}  // namespace curlidar::bench
