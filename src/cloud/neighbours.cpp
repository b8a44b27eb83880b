// SPDX-License-Identifier: BSD-3-Clause
#include "cloud/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nanoflann.hpp>
#include <string>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"

namespace curlidar {
namespace {

/// Returns of a cloud times a power of two, in the shape nanoflann asks for.
struct ReturnSet {
  std::vector<Vec3> points;

  // nanoflann prescribes these names.
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    const Vec3& p = points[i];
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  }
  template <class BoundingBox>
  bool kdtree_get_bbox(BoundingBox&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, ReturnSet>,
                                                 ReturnSet, 3, std::size_t>;

constexpr std::size_t kPointsPerLeaf = 12;
constexpr std::size_t kQueriesPerTask = 2048;

double largest_coordinate(const Cloud& cloud) {
  double largest = 0;
  for (const Vec3& p : cloud.positions) {
    if (is_return(p)) {
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  }
  return largest;
}

/// A power of two that keeps squared distances finite: 1 for every real scan.
double safe_scale(double largest) {
  constexpr int kSafeExponent = 500;
  int exponent = 0;
  std::frexp(largest, &exponent);
  return exponent > kSafeExponent ? std::ldexp(1.0, kSafeExponent - exponent) : 1.0;
}

}  // namespace

Result<std::vector<double>> distances_to_nearest(const Cloud& from, const Cloud& to,
                                                 std::size_t threads) {
  const double scale = safe_scale(std::max(largest_coordinate(from), largest_coordinate(to)));
  ReturnSet set;
  set.points.reserve(to.size());
  for (const Vec3& p : to.positions) {
    if (is_return(p)) set.points.push_back(p * scale);
  }
  if (set.points.empty()) {
    return Error{ErrorCode::invalid_argument,
                 "cannot measure distances to a cloud without a return (all of its " +
                     std::to_string(to.size()) + " points are zero or not finite)"};
  }
  Tree tree(3, set, nanoflann::KDTreeSingleIndexAdaptorParams(kPointsPerLeaf));
  tree.buildIndex();

  std::vector<double> distances(from.size(), std::numeric_limits<double>::quiet_NaN());
  const std::size_t tasks = (from.size() + kQueriesPerTask - 1) / kQueriesPerTask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    const std::size_t end = std::min(from.size(), (task + 1) * kQueriesPerTask);
    for (std::size_t i = task * kQueriesPerTask; i < end; ++i) {
      if (!is_return(from.positions[i])) continue;
      const Vec3 p = from.positions[i] * scale;
      const double query[3] = {p.x, p.y, p.z};
      std::size_t index = 0;
      double squared = 0;
      tree.knnSearch(query, 1, &index, &squared);
      distances[i] = std::sqrt(squared) / scale;
    }
  });
  return distances;
}

Result<double> worse_mean_distance(const Cloud& a, const Cloud& b, std::size_t threads) {
  double worse = 0;
  for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    CURLIDAR_TRY_ASSIGN(distances, distances_to_nearest(*from, *to, threads));
    double sum = 0;
    for (const double d : distances) sum += d;
    worse = std::max(worse, sum / static_cast<double>(std::max<std::size_t>(distances.size(), 1)));
  }
  return worse;
}

}  // namespace curlidar
