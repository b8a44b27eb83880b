// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "compact/scan_types.hpp"

namespace curlidar::compact {

/// What is added to the field's range to have the coded one.
inline std::int32_t offset_of(const RowTable& table, std::uint32_t row) {
  const std::int32_t offset = table.range_offset.empty() ? 0 : table.range_offset[row];
  return table.rays ? offset - table.rays->rays[row].range_phase : offset;
}

}  // namespace curlidar::compact
