// SPDX-License-Identifier: BSD-3-Clause
// A decoded scan into the file that was asked for.
#pragma once

#include <chrono>

#include "common_inputs.hpp"
#include "decode_plan.hpp"

namespace curlidar::app {

using DecodeClock = std::chrono::steady_clock;

/// Reconstructs what the plan wants of the scan, writes it, and tells of it; `start` is when its
/// decoding began.
Outcome write_decoded(const Job& job, const DecodedScan& scan, const DecodePlan& plan,
                      DecodeClock::time_point start, const ProgressCallback& progress);

}  // namespace curlidar::app
