// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/sampler.hpp"

#include <cmath>
#include <cstddef>

namespace curlidar::bench {

std::vector<RangeEstimate> FieldSampler::tell(std::span<const Vec3> directions) const {
  std::vector<RangeEstimate> told(directions.size());
  field_->range_at(directions, told);
  return told;
}

std::vector<RangeEstimate> RingSampler::tell(std::span<const Vec3> directions) const {
  std::vector<RangeEstimate> told(directions.size());
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const RingSamples::Mixed mixed = samples_->mix(directions[i], mixing_);
    if (std::isnan(mixed.range_m)) continue;
    told[i] = {mixed.range_m, static_cast<float>(mixed.agreement), Seen::surface};
  }
  return told;
}

}  // namespace curlidar::bench
