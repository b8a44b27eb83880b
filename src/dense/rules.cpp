// SPDX-License-Identifier: BSD-3-Clause
#include "dense/rules.hpp"

#include <algorithm>
#include <cmath>

namespace curlidar {
namespace {

/// Of inverse ranges: nearer ones are of one surface.
constexpr double kSmooth = 0.2;
/// A plane through two rings comes so near to the third.
constexpr double kPlanar = 0.12;
/// Nothing is seen farther than this.
constexpr double kFarthest_m = 400;

double between(const Look& look) {
  return look.line.inverse_to(look.below.place, look.above.place);
}

/// Whether the plane through `far` and `near` goes on to `next`.
bool goes_on(const Look& look, const RingLook& far, const RingLook& near, const RingLook& next) {
  if (!far.known) return false;
  PlaneLine to_next = look.line;
  to_next.along = {(next.place.rho - look.line.from.rho) / next.r,
                   (next.place.z - look.line.from.z) / next.r};
  const double inverse = to_next.inverse_to(far.place, near.place);
  return std::abs(inverse * next.r - 1) < kPlanar;
}

DenseMode mode_of(const Look& look) {
  const bool above = look.above.known, below = look.below.known;
  if (!above && !below) return DenseMode::none;
  if (!above) return DenseMode::only_below;
  if (!below) return DenseMode::only_above;
  const double near = std::min(look.above.r, look.below.r);
  const double far = std::max(look.above.r, look.below.r);
  if (far - near < kSmooth * near) return DenseMode::smooth;
  if (goes_on(look, look.below2, look.below, look.above) ||
      goes_on(look, look.above2, look.above, look.below)) {
    return DenseMode::planar;
  }
  return look.share > 0.5 ? DenseMode::jump_above : DenseMode::jump_below;
}

double range_of(const Look& look, DenseMode mode) {
  switch (mode) {
    case DenseMode::none:
      return 0;
    case DenseMode::smooth:
    case DenseMode::planar: {
      const double inverse = between(look);
      return inverse > 1 / kFarthest_m ? 1 / inverse : 0;
    }
    case DenseMode::jump_below:
    case DenseMode::only_below:
      return look.below.r;
    case DenseMode::jump_above:
    case DenseMode::only_above:
      return look.above.r;
  }
  return 0;
}

Seen seen_by(const RingPoints& points, const Look& look, const Guess& guess) {
  if (guess.mode == DenseMode::none || !(guess.r > 0)) {
    return points.fired(look.line.azimuth) ? Seen::nothing : Seen::unknown;
  }
  const bool above = look.above.here(), below = look.below.here();
  if (above && below) return Seen::surface;
  if (!above && !below) return points.fired(look.line.azimuth) ? Seen::nothing : Seen::unknown;
  return (above ? look.share : 1 - look.share) >= 0.5 ? Seen::surface : Seen::nothing;
}

/// Beyond the outermost rings: how far in ring steps, and the ring that is continued.
Guess beyond_edge(const RingPoints& points, const Look& look) {
  Guess guess;
  const bool top = look.above.ring < 0;
  const RingLook& edge = top ? look.below : look.above;
  const RingLook& inner = top ? look.below2 : look.above2;
  if (!edge.known) return guess;
  const auto& elevations = points.elevations();
  const std::size_t rings = points.rings();
  const double step = rings < 2 ? 0.01
                      : top     ? elevations[0] - elevations[1]
                                : elevations[rings - 2] - elevations[rings - 1];
  guess.mode = top ? DenseMode::only_below : DenseMode::only_above;
  guess.above_share = top ? 0 : 1;
  guess.r = edge.r;
  if (inner.known && std::abs(inner.r - edge.r) < kSmooth * std::min(inner.r, edge.r)) {
    const double inverse = look.line.inverse_to(edge.place, inner.place);
    if (std::abs(inverse * edge.r - 1) < kSmooth) guess.r = 1 / inverse;
  }
  const double away = std::abs(look.line.side(edge.place)) / edge.r;
  guess.seen = edge.here() && away <= 0.5 * step ? Seen::surface : Seen::unknown;
  return guess;
}

}  // namespace

Guess decide(const RingPoints& points, const Look& look) {
  if (look.above.ring < 0 || look.below.ring < 0) return beyond_edge(points, look);
  Guess guess;
  guess.mode = mode_of(look);
  guess.r = range_of(look, guess.mode);
  switch (guess.mode) {
    case DenseMode::jump_above:
    case DenseMode::only_above:
      guess.above_share = 1;
      break;
    case DenseMode::smooth:
    case DenseMode::planar:
      guess.above_share = look.share;
      break;
    default:
      break;
  }
  guess.seen = seen_by(points, look, guess);
  return guess;
}

float plain_confidence(const Look& look, const Guess& guess, double step_m) {
  if (!(guess.r > 0)) return 0;
  // What the surface may do between samples that lie so far apart, metres.
  const double width = std::max(look.gap, 1e-4) * guess.r;
  double error = 0.5 * step_m + 0.02 + 0.05 * width;
  if (look.above.known && look.below.known) {
    error += 0.05 * std::abs(look.above.r - look.below.r);
  }
  if (guess.mode == DenseMode::planar) error *= 1.5;
  if (guess.jump()) error = 0.3 + error;
  if (guess.mode == DenseMode::only_below || guess.mode == DenseMode::only_above) error *= 3;
  const double there = guess.seen == Seen::surface ? 0.95 : 0.2;
  return static_cast<float>(there * (1 - std::exp(-0.05 / error)));
}

}  // namespace curlidar
