// SPDX-License-Identifier: BSD-3-Clause
// Walks that may follow the order of a cloud's slots.
#pragma once

#include <vector>

#include "records/grid.hpp"
#include "records/order.hpp"
#include "records/walk.hpp"

namespace curlidar {

/// A few walks, one of which follows the slots closely if they come ring by ring or firing by
/// firing. At least one if the grid has rows. O(n log n).
std::vector<Walk> likely_walks(const CloudOrder& order, const CellGrid& grid);

}  // namespace curlidar
