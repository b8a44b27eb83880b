// SPDX-License-Identifier: BSD-3-Clause
// What every codec is given.
#include "peers.hpp"

namespace curlidar::bench {

Cloud returns_of(const Cloud& cloud) {
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (is_return(cloud.positions[i])) indices.push_back(static_cast<std::uint32_t>(i));
  }
  return select(cloud, indices);
}

Result<Grid> make_grid(const Cloud& cloud, const std::string& name) {
  if (!cloud.organised()) {
    return Error{ErrorCode::invalid_argument, name + ": not organised; use curlidar project"};
  }
  Grid grid{{cloud.height, cloud.width, {}}, {}, {}};
  for (const Vec3& p : cloud.positions) {
    grid.mask.occupied.push_back(is_return(p) ? 1 : 0);
    if (!is_return(p)) continue;
    grid.returns.positions.push_back(p);
    grid.ranges_m.push_back(norm(p));
  }
  if (grid.ranges_m.empty()) {
    return Error{ErrorCode::invalid_argument, name + ": no cell holds a return"};
  }
  return grid;
}

}  // namespace curlidar::bench
