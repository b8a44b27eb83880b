// SPDX-License-Identifier: BSD-3-Clause
// The chunk that makes a scan a predicted one: the motion, and what it shares with its reference.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "compact/scan_decoder.hpp"
#include "curlidar/result.hpp"

namespace curlidar::compact {

/// Of all ranges of a scan: tells whether it is the one that was meant.
std::uint16_t fingerprint_of(const DecodedScan& scan);

std::vector<std::byte> write_prediction(const PredictionHeader& header);
Result<PredictionHeader> read_prediction(const ScanChunkView& chunk);

}  // namespace curlidar::compact
