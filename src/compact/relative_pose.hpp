// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "compact/geometry.hpp"

namespace curlidar::compact {

/// How the sensor moved between two scans: takes points of the reference, as seen from its field's
/// centre, to the frame of the scan's. First turned by a rotation vector, then moved.
struct RelativePose {
  static constexpr unsigned kTurnBits = 20;                                ///< of 2^-20 radians
  static constexpr unsigned kMoveBits = 11;                                ///< of 2^-11 metres
  static constexpr std::int32_t kMostTurn = 1 << 21, kMostMove = 1 << 22;  ///< 2 rad, 2048 m

  std::array<std::int32_t, 3> turn{}, move{};

  bool none() const { return *this == RelativePose{}; }
  friend bool operator==(const RelativePose&, const RelativePose&) = default;
};

/// A relative pose as it is applied: rows of the matrix in Q30, the move in Q16 metres.
struct PoseMatrix {
  std::array<Axis, 3> row{};
  std::array<std::int64_t, 3> move{};
};
PoseMatrix matrix_of(const RelativePose& pose);

}  // namespace curlidar::compact
