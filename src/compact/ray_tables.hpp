// SPDX-License-Identifier: BSD-3-Clause
// Frozen tables of sensors' beams: docs/format/beams. They are part of the format.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "compact/ray_table.hpp"

namespace curlidar::compact {

struct BeamTable {
  std::string_view name;     ///< of its file
  std::uint32_t number = 0;  ///< by which files refer to it, from 1 on
  std::uint32_t slots = 0;
  std::uint64_t range_unit_q48 = 0;     ///< ranges are multiples of it, 2^-48 m; 0 = none known
  std::vector<std::int32_t> elevation;  ///< of each row, binary angles
  std::vector<Ray> rays;                ///< of each row
};

/// All tables by number: beam_tables()[i].number = i + 1. Read once.
std::span<const BeamTable> beam_tables();

/// nullptr if there is none of that number.
const BeamTable* beam_table(std::uint32_t number);
/// nullptr if there is none of that name.
const BeamTable* beam_table(std::string_view name);

}  // namespace curlidar::compact
