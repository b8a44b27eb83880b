// SPDX-License-Identifier: BSD-3-Clause
// How the program says what it measured.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "curlidar/compare.hpp"

namespace curlidar::bench {

using Json = nlohmann::ordered_json;

inline Json stats_json(const DistanceStats& stats) {
  return {{"mean", stats.mean}, {"rms", stats.rms}, {"p95", stats.p95}, {"max", stats.max}};
}

/// A line at once, so that whoever reads them sees progress.
inline void print_line(const Json& json) {
  fmt::print("{}\n", json.dump());
  std::fflush(stdout);
}

inline constexpr const char* kNotBuilt = "its library was not found when this was built";

}  // namespace curlidar::bench
