// SPDX-License-Identifier: BSD-3-Clause
// CPU time of this process, which other work on the machine does not lengthen as it does wall time.
#pragma once

#include <ctime>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar::bench {

class CpuWatch {
 public:
  /// Milliseconds since the last lap.
  double lap_ms() {
    const std::clock_t now = std::clock();
    const double ms = 1e3 * static_cast<double>(now - last_) / CLOCKS_PER_SEC;
    last_ = now;
    return ms;
  }

 private:
  std::clock_t last_ = std::clock();
};

inline double median_of(std::vector<double> values) {
  return percentile(values, 0.5);
}

}  // namespace curlidar::bench
