// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "compact/surface.hpp"

namespace curlidar::compact {

struct LearntModels;

/// What a segment of a predicted scan knows beforehand of its cells: as Prediction, of the segment
/// alone.
struct Guide {
  const std::vector<Plane>* planes = nullptr;
  std::vector<std::int32_t> source, range;
  std::vector<std::uint8_t> level, was_there;
  const LearntModels* learnt = nullptr;  ///< what the reference's models knew at its end, if any

  const Plane& plane(std::int32_t at) const { return (*planes)[static_cast<std::size_t>(at)]; }
};

}  // namespace curlidar::compact
