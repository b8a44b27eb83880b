// SPDX-License-Identifier: BSD-3-Clause
#include "metrics/planes.hpp"

#include <cmath>
#include <limits>

namespace curlidar {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool is_defined(const Vec3& normal) {
  return std::isfinite(normal.x) && std::isfinite(normal.y) && std::isfinite(normal.z);
}

/// Normals of b's slots from those of a. The mean is not brought to unit length, as in pc_error.
std::vector<Vec3> carried_normals(const Cloud& b, const std::vector<Vec3>& normals,
                                  const std::vector<Neighbour>& from_a,
                                  const std::vector<Neighbour>& from_b) {
  std::vector<Vec3> sums(b.size());
  std::vector<std::size_t> counts(b.size(), 0);
  for (std::size_t i = 0; i < from_a.size(); ++i) {
    if (std::isnan(from_a[i].distance) || !is_defined(normals[i])) continue;
    sums[from_a[i].slot] = sums[from_a[i].slot] + normals[i];
    ++counts[from_a[i].slot];
  }
  std::vector<Vec3> carried(b.size(), Vec3{kNan, kNan, kNan});
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (std::isnan(from_b[i].distance)) continue;
    carried[i] =
        counts[i] > 0 ? sums[i] * (1.0 / static_cast<double>(counts[i])) : normals[from_b[i].slot];
  }
  return carried;
}

double mean_squared(const Cloud& from, const Cloud& to, const std::vector<Neighbour>& nearest,
                    const std::vector<Vec3>& normals_of_to) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Neighbour& n = nearest[i];
    if (std::isnan(n.distance)) continue;
    const Vec3& normal = normals_of_to[n.slot];
    const double error =
        is_defined(normal) ? dot(from.positions[i] - to.positions[n.slot], normal) : n.distance;
    sum += error * error;
    ++count;
  }
  return sum / static_cast<double>(count);
}

}  // namespace

PlaneErrors plane_errors(const Cloud& a, const Cloud& b, const std::vector<Vec3>& normals,
                         const std::vector<Neighbour>& from_a,
                         const std::vector<Neighbour>& from_b) {
  const std::vector<Vec3> carried = carried_normals(b, normals, from_a, from_b);
  return {mean_squared(a, b, from_a, carried), mean_squared(b, a, from_b, normals)};
}

}  // namespace curlidar
