// SPDX-License-Identifier: BSD-3-Clause
#include "dense/rules.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>

namespace curlidar {
namespace {

/// Rings whose ranges are no farther apart, as a share of the nearer, saw one surface, whatever its
/// slope;
constexpr double kSameShare = 0.1, kSame_m = 0.3;
/// or they did if a plane through two rings comes so near to the third
constexpr double kPlanarApart = 0.35, kPlanar_m = 0.1;  // of how far they are apart
/// or, of surfaces that recede upwards as grounds do, so near.
constexpr double kReceding = 0.12;
/// Rings whose ranges differ by more are not continued by a plane.
constexpr double kContinued = 2;
/// Farther than any sensor sees; planes that meet the line beyond are as good as parallel to it.
constexpr double kFarthest_m = 1000;
/// Slope of what may be ground, what its samples add to it, and how far below the eye it lies.
constexpr double kGroundSlope = 0.15, kGroundNoise_m = 0.05, kGroundBelow_m = 0.5;
/// A ground that ends behind something is seen up to it, give or take.
constexpr double kFoot = 1.02;
/// Rings no farther apart, as a share, are continued by a plane above the top one too.
constexpr double kGentle = 0.05;
/// Upright: out by less than this for each metre up. The ground's plane passes so far behind.
constexpr double kUpright = 0.25, kFootBehind = 0.03;
/// Samples look alike in a vote within this.
constexpr double kAlikeShare = 0.06, kAlike_m = 0.2;
constexpr int kVoters = 6;
constexpr double kVote = 0.25;
/// Of the way between two rings: so near to one its own samples answer, without a vote.
constexpr double kOnRing = 0.1;
/// Two surfaces are.
constexpr double kFarApart_m = 3;
/// Columns: a line passes at a sample; a sample is beside; two follow each other; between two of
/// one surface there may be a hole so wide; samples tell how wild a surface is.
constexpr double kAtSample = 0.1, kBeside = 1.5, kNext = 1.9, kHole = 4.5, kSpreadReach = 2.6;

double met(double inverse) {
  return inverse > 1 / kFarthest_m ? 1 / inverse : 0;
}

PlaneLine towards(const PlaneLine& line, const RingLook& ring) {
  PlaneLine to = line;
  to.along = {(ring.place.rho - line.from.rho) / ring.r, (ring.place.z - line.from.z) / ring.r};
  return to;
}

/// Whether `far` and `near` are known and near enough to make a plane.
bool make_plane(const RingLook& far, const RingLook& near) {
  return far.known && near.known &&
         std::abs(far.r - near.r) <= kContinued * std::min(far.r, near.r);
}

/// By how much the plane through `far` and `near` misses `next`, as a length along its line of
/// sight; infinite if they make none.
double miss(const PlaneLine& line, const RingLook& far, const RingLook& near,
            const RingLook& next) {
  const double nowhere = std::numeric_limits<double>::infinity();
  if (!make_plane(far, near)) return nowhere;
  const double there = met(towards(line, next).inverse_to(far.place, near.place));
  return there > 0 ? std::abs(there - next.r) : nowhere;
}

/// Whether two neighbouring rings lie on ground, `far` farther from the sensor's ring plane.
bool on_ground(const PlaneLine& line, const RingLook& lower, const RingLook& upper) {
  if (!make_plane(lower, upper)) return false;
  const double out = upper.place.rho - lower.place.rho, up = upper.place.z - lower.place.z;
  return out > 0 && std::abs(up) <= kGroundSlope * out + kGroundNoise_m &&
         upper.place.z < line.from.z - kGroundBelow_m;
}

/// Weight of the samples of a ring that look like a range, the nearer ones in azimuth first.
double alike(const RingPoints& points, const PlaneLine& line, const RingLook& ring, double r) {
  const Neighbours beside = neighbours_of(points, line, ring.ring);
  double weight = 0;
  for (int column = -kVoters; column <= kVoters; ++column) {
    const double there = beside.at(column);
    if (there > 0 && std::abs(there - r) < kAlikeShare * r + kAlike_m) {
      weight += 1.0 / (std::abs(column) + 1);
    }
  }
  return weight;
}

/// Of two surfaces the one that reaches further towards the line of sight.
Guess vote(const RingPoints& points, const Look& look) {
  const double above = look.share + kVote * alike(points, look.line, look.below, look.above.r);
  const double below = 1 - look.share + kVote * alike(points, look.line, look.above, look.below.r);
  return above > below ? Guess{DenseMode::jump_above, look.above.r, 1}
                       : Guess{DenseMode::jump_below, look.below.r, 0};
}

/// Whether the line passes at a sample of the ring, or between two that follow each other.
bool has_beside(const RingLook& ring) {
  if (!ring.known) return false;
  return ring.mixed || ring.near <= kAtSample || ring.left.away + ring.right.away <= kNext;
}

/// A line that passes along a ring between two of its samples sees what one of them saw.
std::optional<Guess> on_ring(const Look& look) {
  if (look.share < kOnRing && has_beside(look.below)) {
    return Guess{DenseMode::jump_below, look.below.r, 0};
  }
  if (look.share > 1 - kOnRing && has_beside(look.above)) {
    return Guess{DenseMode::jump_above, look.above.r, 1};
  }
  return std::nullopt;
}

Guess jump(const RingPoints& points, const Look& look) {
  if (const std::optional<Guess> own = on_ring(look)) return *own;
  if (look.above.r > look.below.r && on_ground(look.line, look.below2, look.below)) {
    // The ground goes on until it meets what stands on it.
    const double ground = met(look.line.inverse_to(look.below2.place, look.below.place));
    if (ground > 0 && ground < kFoot * look.above.r) return {DenseMode::jump_below, ground, 0};
    return {DenseMode::jump_above, look.above.r, 1};
  }
  return vote(points, look);
}

/// Where upright things meet the ground below them two planes are seen, not one between them.
std::optional<Guess> foot(const Look& look) {
  if (!on_ground(look.line, look.below2, look.below)) return std::nullopt;
  if (!make_plane(look.above2, look.above)) return std::nullopt;
  const double out = look.above2.place.rho - look.above.place.rho;
  const double up = look.above2.place.z - look.above.place.z;
  if (std::abs(out) > kUpright * up) return std::nullopt;
  const auto& [below2, below, above2, above] =
      std::tie(look.below2, look.below, look.above2, look.above);
  const double behind = towards(look.line, above).inverse_to(below2.place, below.place) * above.r;
  if (behind > 1 - kFootBehind) return std::nullopt;  // the ground is not clearly behind
  const double before = towards(look.line, below).inverse_to(above.place, above2.place) * below.r;
  if (before > 1) return std::nullopt;  // the thing ends above where the ground was seen
  const double ground = met(look.line.inverse_to(below2.place, below.place));
  const double thing = met(look.line.inverse_to(above.place, above2.place));
  if (!(thing > 0) || thing > kFoot * std::max(above.r, below.r)) return std::nullopt;
  if (ground > 0 && ground < thing) return Guess{DenseMode::planar, ground, 0};
  return Guess{DenseMode::planar, thing, 1};
}

bool same_range(const RingLook& a, const RingLook& b) {
  return a.known && b.known && std::abs(a.r - b.r) < kSameShare * std::min(a.r, b.r) + kSame_m;
}

bool one_surface(const Look& look) {
  return same_range(look.above, look.below);
}

bool one_plane(const Look& look) {
  const double a = look.above.r, b = look.below.r, apart = std::abs(a - b);
  const double up = miss(look.line, look.below2, look.below, look.above);
  const double down = miss(look.line, look.above2, look.above, look.below);
  if (std::min(up, down) < kPlanarApart * apart + kPlanar_m) return true;
  return a > b && (up < kReceding * a || down < kReceding * b);
}

/// The same rings some columns aside.
Look aside(const RingPoints& points, const Look& look, int columns) {
  Look there;
  there.line = look.line;
  there.line.azimuth =
      std::remainder(look.line.azimuth + columns * points.column_step(), 2 * std::numbers::pi);
  there.above = look_at_ring(points, there.line, look.above.ring);
  there.below = look_at_ring(points, there.line, look.below.ring);
  there.above2 = look_at_ring(points, there.line, look.above2.ring);
  there.below2 = look_at_ring(points, there.line, look.below2.ring);
  return there;
}

/// one_plane() as most columns around say that see the same two surfaces: noise of single ones
/// would make teeth.
bool one_plane_around(const RingPoints& points, const Look& look) {
  constexpr int kReach = 2;
  int votes = 0;
  for (int columns = -kReach; columns <= kReach; ++columns) {
    const Look there = columns == 0 ? look : aside(points, look, columns);
    const bool same = same_range(there.above, look.above) && same_range(there.below, look.below);
    if (!same || one_surface(there)) continue;
    const int weight = kReach + 1 - std::abs(columns);
    votes += one_plane(there) ? weight : -weight;
  }
  return votes > 0;
}

/// One ring alone: a ground goes on, anything else keeps its distance.
Guess alone(const Look& look) {
  if (look.below.known) {
    Guess guess{DenseMode::only_below, look.below.r, 0};
    if (on_ground(look.line, look.below2, look.below)) {
      const double ground = met(look.line.inverse_to(look.below2.place, look.below.place));
      if (ground > look.below.r && ground < 2 * look.below.r) guess.r = ground;
    }
    return guess;
  }
  Guess guess{DenseMode::only_above, look.above.r, 1};
  if (on_ground(look.line, look.above, look.above2)) {
    const double ground = met(look.line.inverse_to(look.above.place, look.above2.place));
    if (ground < look.above.r && 2 * ground > look.above.r) guess.r = ground;
  }
  return guess;
}

Guess between_rings(const RingPoints& points, const Look& look) {
  if (!look.above.known && !look.below.known) return {};
  if (!look.above.known || !look.below.known) return alone(look);
  const double chord = met(look.line.inverse_to(look.below.place, look.above.place));
  if (const std::optional<Guess> corner = foot(look)) return *corner;
  if (chord > 0 && one_surface(look)) return {DenseMode::smooth, chord, look.share};
  if (chord > 0 && one_plane_around(points, look)) return {DenseMode::planar, chord, look.share};
  return jump(points, look);
}

/// How much of a return a ring lets expect: all beside its samples and in holes of one surface.
double presence(const RingLook& ring) {
  if (!ring.known) return 0;
  if (ring.near <= kBeside || (ring.mixed && ring.left.away + ring.right.away <= kHole)) return 1;
  return 0;
}

Seen seen_by(const RingPoints& points, const Look& look, const Guess& guess) {
  if (guess.mode != DenseMode::none && guess.r > 0) {
    const double above = presence(look.above), below = presence(look.below);
    if (look.share * above + (1 - look.share) * below >= 0.5) return Seen::surface;
  }
  return points.fired(look.line.azimuth) ? Seen::nothing : Seen::unknown;
}

/// How much the samples of a ring around a line of sight differ, as the logarithm of a ratio.
double spread(const RingPoints& points, const PlaneLine& line, const RingLook& ring) {
  if (!ring.known) return 0;
  const auto at = static_cast<std::size_t>(ring.ring);
  const std::size_t beyond = points.first_beyond(at, line.azimuth);
  double least = ring.r, most = ring.r;
  for (std::ptrdiff_t step = -2; step < 2; ++step) {
    const RingPoint& p = points.walk(at, beyond, step);
    const double away = std::abs(turn_between(line.azimuth, p.azimuth)) / points.column_step();
    if (away > kSpreadReach) continue;
    const double r = line.distance({p.rho, p.z});
    least = std::min(least, r);
    most = std::max(most, r);
  }
  return std::log(most / least);
}

/// Of a guess at something that is there. As counted where rings of six sensors were left out.
double doubt_of_range(const RingPoints& points, const Look& look, const Guess& guess) {
  // The wrong one of two surfaces is the worse the farther they are apart.
  if (guess.jump()) {
    return 0.65 + 0.2 * (1 - std::exp(-std::abs(look.above.r - look.below.r) / kFarApart_m));
  }
  const double wild =
      std::max(spread(points, look.line, look.above), spread(points, look.line, look.below));
  switch (guess.mode) {
    case DenseMode::smooth:
      return std::min(0.01 + 1.2 * wild, 0.16);
    case DenseMode::planar:
      return std::min(0.01 + 3 * wild, 0.4);
    default:
      return std::min(0.1 + wild, 0.3);
  }
}

/// Whether there is anything, counted likewise: as good as certain between two samples, even odds
/// beside one, hardly in a gap.
double return_share(const Look& look) {
  const double beside = presence(look.above) + presence(look.below);
  return beside > 1.5 ? 0.97 : beside > 0.5 ? 0.5 : 0.1;
}

double doubt_of(const RingPoints& points, const Look& look, const Guess& guess) {
  if (!(guess.r > 0)) return 1;
  return 1 - return_share(look) * (1 - doubt_of_range(points, look, guess));
}

/// Beyond the outermost rings: theirs, believed for half a step. What lies above the top ring
/// mostly stands upright, and planes through two rings far apart end in the far: there, and farther
/// up, it keeps its distance.
Guess beyond_edge(const RingPoints& points, const Look& look) {
  const bool top = look.above.ring < 0;
  const RingLook& edge = top ? look.below : look.above;
  const RingLook& inner = top ? look.below2 : look.above2;
  if (!edge.known) return {};
  const auto& elevations = points.elevations();
  const std::size_t rings = points.rings();
  const double step = rings < 2 ? 0.01
                      : top     ? elevations[0] - elevations[1]
                                : elevations[rings - 2] - elevations[rings - 1];
  const bool near = std::abs(look.line.side(edge.place)) <= 0.5 * step * edge.r;
  Guess guess{top ? DenseMode::only_below : DenseMode::only_above, edge.r, top ? 0.0 : 1.0};
  const bool gentle = std::abs(inner.r - edge.r) <= kGentle * std::min(inner.r, edge.r);
  const bool goes_on = top ? near && gentle && make_plane(inner, edge)
                           : same_range(inner, edge) || on_ground(look.line, edge, inner);
  if (goes_on) {
    const double there = met(look.line.inverse_to(inner.place, edge.place));
    if (there > edge.r / 2 && there < 2 * edge.r) guess.r = there;
  }
  guess.doubt = doubt_of(points, look, guess);
  guess.seen = edge.here() && near ? Seen::surface : Seen::unknown;
  return guess;
}

}  // namespace

Guess decide(const RingPoints& points, const Look& look) {
  if (look.above.ring < 0 || look.below.ring < 0) return beyond_edge(points, look);
  Guess guess = between_rings(points, look);
  guess.seen = seen_by(points, look, guess);
  guess.doubt = doubt_of(points, look, guess);
  return guess;
}

}  // namespace curlidar
