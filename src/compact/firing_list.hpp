// SPDX-License-Identifier: BSD-3-Clause
// At which positions of its encoder a sensor fired.
#pragma once

#include <cstdint>
#include <vector>

#include "entropy/range_coder.hpp"

namespace curlidar::compact {

/// Writes positions that are strictly ascending and below `slots`. Steps are modelled from the two
/// before, from how long they have been the same, and from how far the position is from that of
/// a steady turn: some .15 bits a step of an HDL-64E, 1.6 where 2000 firings lie among 36000
/// positions, next to nothing where steps are all alike.
void write_firings(RangeEncoder& encoder, const std::vector<std::uint32_t>& firings,
                   std::uint32_t slots);

/// Reads `count` positions, 1 .. slots. False if they are not ascending below `slots` or the bytes
/// end before. Memory grows with what is read.
bool read_firings(RangeDecoder& decoder, std::uint32_t count, std::uint32_t slots,
                  std::vector<std::uint32_t>& firings);

}  // namespace curlidar::compact
