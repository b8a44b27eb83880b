// SPDX-License-Identifier: BSD-3-Clause
// The methods that are compared between the rows, and what is said of each.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "curlidar/codec.hpp"
#include "report/measure/json.hpp"
#include "report/measure/sampler.hpp"

namespace curlidar::bench {

struct Method {
  std::string name, setting;
  std::string skipped;  ///< why there is no sampler
  std::shared_ptr<const Sampler> sampler;
  std::size_t bytes = 0;  ///< of its file; 0: raw samples
  double bits_per_point = 0;
  double cp_paper_percent = 0;  ///< of the paper's methods

  Json header() const;
};

/// What the methods are made of.
struct MethodInput {
  const Cloud* cloud = nullptr;
  EncodeSettings paper;                         ///< of Profile::paper, upsampling left open
  std::optional<SensorProfile> compact_sensor;  ///< for the compact codec; else it finds its own
  /// For interpolation: rings, their elevations as seen from the origin, columns of a turn.
  std::vector<std::uint16_t> ring_of_point;
  std::vector<double> ring_elevations;
  std::uint32_t columns = 0;
};

/// The paper's S = 1x1, 2x1, 2x2, with the other settings as given.
std::vector<Method> paper_methods(const Cloud& cloud, EncodeSettings settings);
/// The paper's baseline, one expansion of the whole scan.
Method baseline_method(const Cloud& cloud, EncodeSettings settings);
/// The paper's; compact at 5 cm and at 1 bit a point with every return; linear and
/// edge-aware interpolation.
std::vector<Method> make_methods(const MethodInput& input);

struct RangeLimits {
  double min_m = 0, max_m = 0;
  bool hold(double range_m) const { return range_m >= min_m && range_m <= max_m; }
};

/// What came of a set of rays.
struct RayErrors {
  std::size_t points = 0;
  DistanceStats stats;    ///< of the points whose ray meets a surface, metres along the ray
  double within_5cm = 0;  ///< share of these points
  double completeness =
      0;  ///< share with a point of the rays that meet a surface within the limits
  std::size_t no_surface = 0;  ///< points whose ray meets none
};
/// With points, mean, rms, p50, p95, max.
Json to_json(const RayErrors& errors);

/// Errors along rays. Ranges told outside the limits are as good as none; every other one counts,
/// wherever the surface is.
class RayTally {
 public:
  explicit RayTally(const RangeLimits& limits) : limits_(limits) {}

  /// `true_m` is the range of the surface that the ray meets, nothing if it meets none.
  void add(double told_m, std::optional<double> true_m);
  RayErrors errors() const;

 private:
  RangeLimits limits_;
  std::vector<double> errors_m_;
  std::size_t wanted_ = 0, found_ = 0, no_surface_ = 0;
};

}  // namespace curlidar::bench
