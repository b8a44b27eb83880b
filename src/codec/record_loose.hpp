// SPDX-License-Identifier: BSD-3-Clause
// Points without a cell, as exactly as a file's target asks.
#pragma once

#include <cstdint>
#include <vector>

#include "curlidar/codec.hpp"
#include "records/loose.hpp"

namespace curlidar {

/// The few that an image leaves over: well within the target, so that they do not matter to it.
Result<CodedPoints> encode_leftovers(const std::vector<Vec3>& points, ScalarType type,
                                     const CompactSettings& settings, double error_m);

/// A whole cloud: the coarsest steps that reach the target. Errors: invalid_argument (out of
/// reach).
Result<CodedPoints> encode_all_loose(const std::vector<Vec3>& points, ScalarType type,
                                     const CompactSettings& settings, double beside_bits,
                                     std::size_t threads);

}  // namespace curlidar
