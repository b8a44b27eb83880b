// SPDX-License-Identifier: BSD-3-Clause
// Nearest neighbours between clouds.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// Slots that one task of a parallel search over a cloud takes.
inline constexpr std::size_t kQueriesPerTask = 2048;

/// A return of a cloud, and how far it is from where was asked.
struct Neighbour {
  std::size_t slot = 0;
  double distance = std::numeric_limits<double>::infinity();
};

/// The returns of a cloud as a k-d tree. Exact.
class ReturnTree {
 public:
  /// O(n log n). `queries` is where nearest() will be asked: what both clouds hold decides how far
  /// coordinates are scaled down, so that squared distances stay finite. Both may be one cloud.
  ReturnTree(const Cloud& cloud, const Cloud& queries);
  ~ReturnTree();
  ReturnTree(ReturnTree&&) noexcept;
  ReturnTree& operator=(ReturnTree&&) noexcept;

  /// Number of returns.
  std::size_t size() const;
  /// Fills the first min(found.size(), size()) entries with the returns nearest to `query`, nearest
  /// first, equally near ones in the order of their slots, and gives that number. May be called
  /// from several threads. O(log n) for scattered points.
  std::size_t nearest(const Vec3& query, std::span<Neighbour> found) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

/// The nearest return of `to` for every slot of `from`; distance NaN where `from` has none. `to`
/// must have a return (invalid_argument). threads: 0 = all cores.
Result<std::vector<Neighbour>> nearest_returns(const Cloud& from, const Cloud& to,
                                               std::size_t threads);

/// What nearest_distances of curlidar/compare.hpp promises.
Result<std::vector<double>> distances_to_nearest(const Cloud& from, const Cloud& to,
                                                 std::size_t threads);

/// The larger of the two mean distances to the nearest neighbour, a to b and b to a; 0 if both are
/// empty. Errors: invalid_argument (one has no return).
Result<double> worse_mean_distance(const Cloud& a, const Cloud& b, std::size_t threads);

}  // namespace curlidar
