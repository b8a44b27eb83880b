// SPDX-License-Identifier: BSD-3-Clause
#include "dense/confidence.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace curlidar {
namespace {

constexpr double kClose_m = 0.05;  ///< what confidence is about
/// Places so smooth tell the noise: rings on both sides, apart by less than this share.
constexpr double kSmoothApart = 0.05;
constexpr std::size_t kMostSamples = 20000;
/// Median error on a surface: of the noise, and a share of how far apart the rings are.
constexpr double kSlopeShare = 0.06;
constexpr double kLeastError_m = 0.002;

}  // namespace

double ring_noise_m(const RingPoints& points) {
  std::vector<double> misses;
  std::size_t samples = 0;
  for (std::size_t ring = 0; ring < points.rings(); ++ring) samples += points.ring(ring).size();
  const std::size_t stride = samples / kMostSamples + 1;
  for (std::size_t ring = 1; ring + 1 < points.rings(); ++ring) {
    for (std::size_t i = 0; i < points.ring(ring).size(); i += stride) {
      const RingPoint& p = points.ring(ring)[i];
      PlaneLine line{p.azimuth, {0, points.height_m(ring)}, {}};
      const double r = line.distance({p.rho, p.z});
      line.along = {p.rho / r, (p.z - line.from.z) / r};
      const auto at = static_cast<std::ptrdiff_t>(ring);
      const RingLook above = look_at_ring(points, line, at - 1);
      const RingLook below = look_at_ring(points, line, at + 1);
      if (!above.mixed || !below.mixed || !above.here() || !below.here()) continue;
      if (std::abs(above.r - below.r) > kSmoothApart * std::min(above.r, below.r)) continue;
      const double inverse = line.inverse_to(below.place, above.place);
      if (inverse > 0) misses.push_back(std::abs(1 / inverse - r));
    }
  }
  if (misses.empty()) return 0;
  const auto middle = misses.begin() + static_cast<std::ptrdiff_t>(misses.size() / 2);
  std::nth_element(misses.begin(), middle, misses.end());
  return *middle;
}

float plain_confidence(const Look& look, const Guess& guess, double noise_m) {
  if (!(guess.r > 0)) return 0;
  double error = std::max(noise_m, kLeastError_m);
  if (look.above.known && look.below.known && !guess.jump()) {
    error = std::hypot(error, kSlopeShare * std::abs(look.above.r - look.below.r));
  }
  return static_cast<float>((1 - guess.doubt) * (1 - std::exp2(-kClose_m / error)));
}

}  // namespace curlidar
