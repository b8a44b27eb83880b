// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/returns.hpp"

#include <algorithm>

namespace curlidar {

Returns gather_returns(const Cloud& cloud) {
  Returns out;
  const std::size_t count = count_returns(cloud);
  out.slot.reserve(count);
  for (auto* column : {&out.range, &out.distance, &out.height, &out.azimuth, &out.elevation}) {
    column->reserve(count);
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.positions[i];
    if (!is_return(p)) continue;
    const double distance = std::sqrt(p.x * p.x + p.y * p.y);
    out.slot.push_back(static_cast<std::uint32_t>(i));
    out.range.push_back(std::sqrt(distance * distance + p.z * p.z));
    out.distance.push_back(distance);
    out.height.push_back(p.z);
    out.azimuth.push_back(azimuth_of(p));
    out.elevation.push_back(std::atan2(p.z, distance));
  }
  if (count > 0) {
    std::vector<double> ranges(out.range);
    out.far_m = std::min(3.0, median(ranges));
  }
  return out;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace curlidar
