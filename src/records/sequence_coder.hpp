// SPDX-License-Identifier: BSD-3-Clause
// Whole numbers that follow rules: rings, times, counters. Each is coded as what it differs by from
// a simple forecast.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "entropy/range_coder.hpp"
#include "records/grid.hpp"

namespace curlidar {

/// What a number is forecast from.
enum class Forecast : std::uint8_t {
  last,    ///< the number of the point before, in the order of the slots
  line,    ///< the line through those of the two points before
  left,    ///< the number of the record before
  firing,  ///< that of the firing plus that of the row
};
inline constexpr std::uint8_t kForecasts = 4;

/// Where numbers are: the geometry, and the record of each point in the order of the slots.
struct SequencePlaces {
  const RecordGeometry& geometry;
  std::span<const std::uint32_t> slots;
};

/// Codes a number for each record, in the order of the records.
void write_sequence(RangeEncoder& coder, Forecast forecast, const SequencePlaces& places,
                    const std::vector<std::int64_t>& numbers);
/// What write_sequence would spend, in 1/256 bit.
std::uint64_t sequence_cost(Forecast forecast, const SequencePlaces& places,
                            const std::vector<std::int64_t>& numbers);
/// False if the bytes end before the numbers do.
bool read_sequence(RangeDecoder& coder, Forecast forecast, const SequencePlaces& places,
                   std::vector<std::int64_t>& numbers);

}  // namespace curlidar
