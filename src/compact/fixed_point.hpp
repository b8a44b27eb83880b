// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace curlidar::compact {

/// A point in Q36 metres.
struct FixedPoint {
  std::int64_t x = 0, y = 0, z = 0;

  friend bool operator==(const FixedPoint&, const FixedPoint&) = default;
};

}  // namespace curlidar::compact
