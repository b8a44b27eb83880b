// SPDX-License-Identifier: BSD-3-Clause
// Scans as rows of cells, of which some will be given and the others asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"
#include "dense/density_profile.hpp"
#include "dense/ring_points.hpp"
#include "sensor/lattice.hpp"

namespace curlidar::density {

/// Where a row looked once.
struct RowCell {
  std::uint16_t row = 0;  ///< from the top
  float azimuth = 0;      ///< radians in [-pi, pi]
  float elevation = 0;    ///< of the return, seen from the origin; means nothing without one
  float range_m = 0;      ///< 0: no return
};

struct RowScan {
  std::string group;               ///< sensor or drive: what is judged without having taught
  std::vector<double> elevations;  ///< of the rows, nominal, radians, descending
  std::uint32_t columns = 0;
  bool exact = false;  ///< elevations of given returns are known to who predicts
  std::vector<RowCell> cells;
};

/// A scan in its sensor's own frame; as it is where its motion cannot be told.
struct OwnScan {
  std::string path;
  Cloud cloud;
  Detection rings;
  std::optional<LatticeFit> lattice;

  /// The beams of the rings, as far as they are known.
  const BeamModel* beams() const;
};
Result<OwnScan> read_own_frame(const std::string& path);

/// The cells of the 64 x 1024 image of TULIP's protocol, bench/protocol/tulip_image.hpp.
Result<RowScan> image_rows(const Cloud& own);

/// The returns of a sensor's rings, and the columns missing between them. Errors: unsupported where
/// no rings are found.
Result<RowScan> ring_rows(const OwnScan& own);

/// The returns of the given rows, or of the others, on their rings; where elevations are not known
/// they are the profile's.
RingPoints rings_of(const RowScan& scan, const DensityProfile& profile, bool given);

}  // namespace curlidar::density
