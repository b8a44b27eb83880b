// SPDX-License-Identifier: BSD-3-Clause
// Projection of a raw scan to a gridded, organised cloud of cell-centre points.
#pragma once

#include <cstddef>
#include <cstdint>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"

namespace curlidar {

/// Where the rows of a range image look.
enum class RowRule {
  uniform,  ///< evenly spaced over the nominal field of view (the paper)
  rings,    ///< at the elevation of each true ring
};

/// An upper limit of range: metres, or a percentile of range over all returns of the scan.
struct RangeLimit {
  double metres = 0;      ///< used when percentile is 0; 0 = the sensor's limit
  double percentile = 0;  ///< in (0, 100]; 90 is the paper's outdoor cut
};

struct ProjectSettings {
  RowRule row_rule = RowRule::uniform;
  std::uint32_t rows = 0;  ///< number of uniform rows; 0 = the sensor's ring count
  std::uint32_t columns = 1024;
  double min_range_m = 0;
  RangeLimit max_range{};
};

/// Where every return went. The fields add up to `returns`.
struct ProjectionCounts {
  std::size_t returns = 0;
  std::size_t kept = 0;          ///< cells filled
  std::size_t outliers = 0;      ///< dropped by the outlier filter before projection
  std::size_t out_of_range = 0;  ///< nearer than min or beyond max range
  std::size_t out_of_fov = 0;    ///< above or below the nominal field of view
  std::size_t collided = 0;      ///< another return, nearer the cell's centre, holds the cell
};

/// Organised rows x columns cloud, NaN in empty cells, attributes of the winning returns.
/// `detection` gives the sensor and (for RowRule::rings) the ring of each point.
Result<Cloud> project(const Cloud& cloud, const Detection& detection,
                      const ProjectSettings& settings, ProjectionCounts* counts = nullptr);

}  // namespace curlidar
