// SPDX-License-Identifier: BSD-3-Clause
// What is told along lines of sight against what is there.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "curlidar/compare.hpp"
#include "curlidar/field.hpp"
#include "report/measure/json.hpp"

namespace curlidar::bench {

struct RangeLimits {
  double min_m = 0, max_m = std::numeric_limits<double>::infinity();
  bool hold(double range_m) const { return range_m >= min_m && range_m <= max_m; }
};

/// What came of a set of lines.
struct RayErrors {
  std::size_t points = 0;  ///< lines that were told a surface within the limits
  DistanceStats stats;     ///< of the points whose line meets a surface, metres along the line
  double within_5cm = 0;   ///< share of these points
  double completeness =
      0;  ///< share with a point of the lines that meet a surface within the limits
  std::size_t no_surface = 0;  ///< points whose line meets none
};

/// Two methods cut to equally many of the lines that meet a surface: each keeps those that it
/// trusts most.
struct EqualCut {
  double completeness = 0;
  double p50 = 0, p95 = 0;              ///< of the one that is judged
  double other_p50 = 0, other_p95 = 0;  ///< of the one that it is compared with
};

/// A told confidence beside what was observed.
struct ConfidenceBin {
  std::size_t count = 0;  ///< lines told a confidence in [i / 10, (i + 1) / 10)
  double told = 0;        ///< their mean confidence
  double observed = 0;    ///< share of them within 5 cm of a surface that is there
};

/// What a least confidence leaves.
struct Trade {
  double min_confidence = 0, completeness = 0, p50 = 0, p95 = 0, within_5cm = 0;
};

/// Judges what methods tell along the same lines. Ranges told outside the limits are as good as
/// none.
class Judge {
 public:
  /// `true_m[i]`: range of the surface that line i meets, NaN if it meets none.
  Judge(std::vector<double> true_m, const RangeLimits& limits);

  /// Every told surface counts, wherever the true one is.
  RayErrors errors(std::span<const RangeEstimate> told) const;
  /// Errors where a surface within the limits is met and told, most trusted first: by confidence,
  /// equally trusted ones in an order that has nothing to do with where they are.
  std::vector<double> ranked(std::span<const RangeEstimate> told) const;
  EqualCut equal_cut(std::span<const RangeEstimate> told,
                     std::span<const RangeEstimate> other) const;
  /// The most trusted ones, `share` of the lines that meet a surface; all that are told if these
  /// are fewer.
  Trade most_trusted(std::span<const RangeEstimate> told, double share) const;
  /// Ten bins over all lines that are told a range, believed or not, of any limits.
  std::vector<ConfidenceBin> confidence(std::span<const RangeEstimate> told) const;
  /// For every twentieth from 0 to .95.
  std::vector<Trade> trades(std::span<const RangeEstimate> told) const;

  const std::vector<double>& true_m() const { return true_m_; }

 private:
  bool is_told(const RangeEstimate& estimate) const;
  Trade trade_of(std::vector<double> errors) const;

  std::vector<double> true_m_;
  RangeLimits limits_;
  std::size_t wanted_ = 0;
};

/// With points, mean, rms, p50, p95, max.
Json to_json(const RayErrors& errors);
Json to_json(const EqualCut& cut);
Json to_json(const std::vector<ConfidenceBin>& bins);
Json to_json(const Trade& trade);
Json to_json(const std::vector<Trade>& trades);

}  // namespace curlidar::bench
