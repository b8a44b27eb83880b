// SPDX-License-Identifier: BSD-3-Clause
// The chunk of a sensor's own rays: firings, beams, motion.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "compact/scan_types.hpp"
#include "curlidar/result.hpp"

namespace curlidar::compact {

/// No number of a motion is larger: a radian, 16 km.
inline constexpr std::int32_t kMostMotion = 1 << 30;

/// invalid_argument unless the rays of a table (which has some) can be written for an image of
/// `rows` x `columns`: a ray and an elevation for each row, a firing for each column, the columns
/// of a whole turn; numbers within their limits and multiples of their shifts; and, where a frozen
/// table is named, equal to it with shifts of 0.
Status check_rays(const RowTable& table, std::uint32_t rows, std::uint32_t columns);

/// Sets slots, elevations, rays and their shifts to those of a frozen table. False if there is none
/// of that number.
bool use_beam_table(std::uint32_t number, RowTable& table);

/// Writes rays and elevations of a table that check_rays() finds right.
std::vector<std::byte> write_rays(const RowTable& table);

/// Firings and motion alone, of a table whose beams the reader has.
std::vector<std::byte> write_firings_only(const RowTable& table);
/// Reads those into a table with beams.
Status read_firings_only(const ScanChunkView& chunk, std::uint32_t columns, RowTable& table);

/// Fills `rays` and `elevation`; `rows` and `columns` have been checked against the limits. Errors:
/// corrupt, unsupported (flags or a beam table of a later version).
Status read_rays(const ScanChunkView& chunk, std::uint32_t rows, std::uint32_t columns,
                 RowTable& table);

}  // namespace curlidar::compact
