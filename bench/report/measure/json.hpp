// SPDX-License-Identifier: BSD-3-Clause
// Measurements as lines of JSON.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "curlidar/compare.hpp"

namespace curlidar::bench {

using Json = nlohmann::ordered_json;

/// Prints one line and sends it off.
void print_line(const Json& json);

/// count, mean, std, rms, p50, p95, max; metres.
Json to_json(const DistanceStats& stats);

/// The 101 whole percentiles of the distances that are numbers; empty if there is none.
Json percentiles_of(std::vector<double> distances);

}  // namespace curlidar::bench
