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
#include "cloud/kd_points.hpp"

namespace curlidar {
namespace {

/// Returns of a cloud times a power of two.
struct ReturnSet : KdPoints {
  std::vector<std::size_t> slots;  // ascending
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, ReturnSet>,
                                                 ReturnSet, 3, std::size_t>;

constexpr std::size_t kPointsPerLeaf = 12;

/// The best points seen, by squared distance and then by index: nanoflann's own set keeps whichever
/// of equally near points the tree shows first.
class OrderedResult {
 public:
  explicit OrderedResult(std::span<Neighbour> best) : best_(best) {}

  // nanoflann prescribes these names and types.
  using DistanceType = double;
  using IndexType = std::size_t;
  using CountType = std::size_t;
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == best_.size(); }
  /// The search drops what is not below this, so equally near points must be.
  double worstDist() const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return full() ? std::nextafter(best_[count_ - 1].distance, kInfinity) : kInfinity;
  }
  bool addPoint(double squared, std::size_t index) {
    const auto before = [&](const Neighbour& n) {
      return squared < n.distance || (squared == n.distance && index < n.slot);
    };
    if (full() && !before(best_[count_ - 1])) return true;
    std::size_t place = full() ? count_ - 1 : count_++;
    for (; place > 0 && before(best_[place - 1]); --place) best_[place] = best_[place - 1];
    best_[place] = {index, squared};
    return true;
  }
  void sort() {}

 private:
  std::span<Neighbour> best_;
  std::size_t count_ = 0;
};

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

struct ReturnTree::Index {
  ReturnSet set;
  double scale = 1;
  std::unique_ptr<Tree> tree;  // refers to set
};

ReturnTree::ReturnTree(const Cloud& cloud, const Cloud& queries)
    : index_(std::make_unique<Index>()) {
  index_->scale = safe_scale(std::max(largest_coordinate(cloud), largest_coordinate(queries)));
  ReturnSet& set = index_->set;
  set.points.reserve(cloud.size());
  set.slots.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_return(cloud.positions[i])) continue;
    set.points.push_back(cloud.positions[i] * index_->scale);
    set.slots.push_back(i);
  }
  if (set.points.empty()) return;
  index_->tree =
      std::make_unique<Tree>(3, set, nanoflann::KDTreeSingleIndexAdaptorParams(kPointsPerLeaf));
  index_->tree->buildIndex();
}

ReturnTree::~ReturnTree() = default;
ReturnTree::ReturnTree(ReturnTree&&) noexcept = default;
ReturnTree& ReturnTree::operator=(ReturnTree&&) noexcept = default;

std::size_t ReturnTree::size() const {
  return index_->set.points.size();
}

std::size_t ReturnTree::nearest(const Vec3& query, std::span<Neighbour> found) const {
  found = found.first(std::min(found.size(), size()));
  if (found.empty()) return 0;
  const Vec3 p = query * index_->scale;
  const double coordinates[3] = {p.x, p.y, p.z};
  OrderedResult result(found);
  index_->tree->findNeighbors(result, coordinates, {});
  for (Neighbour& n : found) {
    n = {index_->set.slots[n.slot], std::sqrt(n.distance) / index_->scale};
  }
  return found.size();
}

Result<std::vector<Neighbour>> nearest_returns(const Cloud& from, const Cloud& to,
                                               std::size_t threads) {
  const ReturnTree tree(to, from);
  if (tree.size() == 0) {
    return Error{ErrorCode::invalid_argument,
                 "cannot measure distances to a cloud without a return (all of its " +
                     std::to_string(to.size()) + " points are zero or not finite)"};
  }
  std::vector<Neighbour> nearest(from.size(), {0, std::numeric_limits<double>::quiet_NaN()});
  const std::size_t tasks = (from.size() + kQueriesPerTask - 1) / kQueriesPerTask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    const std::size_t end = std::min(from.size(), (task + 1) * kQueriesPerTask);
    for (std::size_t i = task * kQueriesPerTask; i < end; ++i) {
      if (is_return(from.positions[i])) tree.nearest(from.positions[i], {&nearest[i], 1});
    }
  });
  return nearest;
}

Result<std::vector<double>> distances_to_nearest(const Cloud& from, const Cloud& to,
                                                 std::size_t threads) {
  CURLIDAR_TRY_ASSIGN(nearest, nearest_returns(from, to, threads));
  std::vector<double> distances;
  distances.reserve(nearest.size());
  for (const Neighbour& n : nearest) distances.push_back(n.distance);
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
