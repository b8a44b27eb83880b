// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <fmt/format.h>

namespace curlidar::bench {

void print_line(const Json& json) {
  fmt::print("{}\n", json.dump());
  std::fflush(stdout);
}

Json to_json(const DistanceStats& stats) {
  return {{"count", stats.count}, {"mean", stats.mean}, {"std", stats.std}, {"rms", stats.rms},
          {"p50", stats.p50},     {"p95", stats.p95},   {"max", stats.max}};
}

Json percentiles_of(std::vector<double> distances) {
  constexpr int kPercentiles = 100;
  std::erase_if(distances, [](double d) { return std::isnan(d); });
  Json quantiles = Json::array();
  if (distances.empty()) return quantiles;
  std::sort(distances.begin(), distances.end());
  for (int i = 0; i <= kPercentiles; ++i) {
    quantiles.push_back(percentile(distances, static_cast<double>(i) / kPercentiles));
  }
  return quantiles;
}

}  // namespace curlidar::bench
