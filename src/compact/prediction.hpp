// SPDX-License-Identifier: BSD-3-Clause
// What the scan before makes expect of a scan: its decoded surfaces, moved as the sensor did and
// seen from the scan's own cells. All integers: decoder and encoder must agree on every cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "compact/prediction_guide.hpp"
#include "compact/relative_pose.hpp"
#include "compact/scan_decoder.hpp"
#include "compact/scan_types.hpp"
#include "compact/surface.hpp"

namespace curlidar::compact {

/// For each cell of a scan, row by row, what its reference makes expect there.
struct Prediction {
  /// No return falls into the cell and none within kLevels cells of it.
  static constexpr std::uint8_t kLevels = 8;
  static constexpr std::int32_t kNone = -1;

  std::uint32_t rows = 0, columns = 0;
  std::vector<Plane> planes;            ///< of the cells into which returns of the reference fall
  std::vector<std::int32_t> source;     ///< of each cell: place in `planes`, or kNone
  std::vector<std::int32_t> range;      ///< of that plane in the cell's line of sight, Q16; 0: none
  std::vector<std::uint8_t> level;      ///< cells to the nearest with a plane of its own; kLevels
  std::vector<std::uint8_t> was_there;  ///< the reference has a return where the cell is now
  std::shared_ptr<const LearntModels> learnt;  ///< of the reference, if it is one segment
};

/// Moves and projects. The tables must be valid. O(cells), some 100 ns each.
Prediction predict(const DecodedScan& reference, const RelativePose& pose, const RowTable& table,
                   std::uint32_t rows, std::uint32_t columns);

/// What a segment sees of a prediction, which must outlive it.
Guide guide_of(const Prediction& prediction, const SegmentPlace& place);

}  // namespace curlidar::compact
