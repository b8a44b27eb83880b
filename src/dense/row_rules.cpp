// SPDX-License-Identifier: BSD-3-Clause
#include "dense/row_rules.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "curlidar/cloud.hpp"
#include "sensor/angles.hpp"

namespace curlidar {
namespace {

constexpr double kSomewhere_m = 20;  ///< where a row is looked for before anything is found
constexpr double kOwn = 0.25;        ///< of the step to the next row: lines of the row itself

/// Rings may look so much beside what a profile says even if rows lie closely.
constexpr double kSomeAngle = 1e-3;

PlaneLine line_at(double azimuth, double elevation) {
  return {azimuth, {0, 0}, {std::cos(elevation), std::sin(elevation)}};
}

bool on_one_surface(const Guess& guess) {
  return guess.mode == DenseMode::smooth || guess.mode == DenseMode::planar;
}

/// Angle to the next row.
double row_step(const DensityProfile& profile, std::size_t row) {
  if (profile.rows < 2) return 0;
  const std::size_t other = row + 1 < profile.rows ? row + 1 : row - 1;
  return std::abs(profile.elevation(other, kSomewhere_m) - profile.elevation(row, kSomewhere_m));
}

/// How far above a row the returns of a ring lie, radians; 0 if there are none.
double median_beside(const DensityProfile& profile, std::size_t row,
                     std::span<const RingPoint> ring) {
  constexpr std::size_t kMost = 200;
  std::vector<double> beside;
  for (std::size_t i = 0; i < ring.size(); i += ring.size() / kMost + 1) {
    const double r = std::hypot(ring[i].rho, ring[i].z);
    beside.push_back(std::atan2(ring[i].z, ring[i].rho) - profile.elevation(row, r));
  }
  return beside.empty() ? 0 : percentile(beside, 0.5);
}

}  // namespace

Status check_rows(const DensityProfile& profile, const RingPoints& points) {
  const auto invalid = [&](std::string what) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("density profile \"{}\": {}", profile.name, what)};
  };
  if (profile.rows == 0) return {};
  const std::size_t given =
      (profile.rows - profile.given_first + profile.given_every - 1) / profile.given_every;
  if (given != points.rings()) {
    return invalid(fmt::format("it is for {} rings, not for {}", given, points.rings()));
  }
  for (std::size_t ring = 0; ring < given; ++ring) {
    const std::size_t row = profile.given_first + ring * profile.given_every;
    const double beside = median_beside(profile, row, points.ring(ring));
    if (std::abs(beside) <= std::max(row_step(profile, row) / 2, kSomeAngle)) continue;
    return invalid(fmt::format("the returns of ring {} lie {:.3f} degrees beside row {}", ring,
                               degrees_of(beside), row));
  }
  return {};
}

RowRules::RowRules(const RingPoints& points, const DensityProfile& profile, ScanErrors errors,
                   std::vector<double> offset_m)
    : points_(points),
      profile_(profile),
      errors_(std::move(errors)),
      offset_m_(std::move(offset_m)) {}

RowRules::RowRules(const RingPoints& points, const DensityProfile& profile)
    : RowRules(points, profile, errors_of(points)) {}

RowFeatures RowRules::features(std::size_t row, const RowGuess& found) const {
  return row_features(plain_features(points_, found.look, found.guess, errors_), profile_, row,
                      found.look, found.guess);
}

RowGuess RowRules::look_along_row(std::size_t row, double azimuth) const {
  // Rows look up or down by a little less or more at near things; it settles at once.
  constexpr int kPasses = 3;
  constexpr double kClose = 1e-5;  // radians
  RowGuess found;
  double elevation = profile_.elevation(row, kSomewhere_m);
  for (int pass = 0; pass < kPasses; ++pass) {
    found.look = look_along(points_, line_at(azimuth, elevation));
    found.guess = decide(points_, found.look);
    if (!(found.guess.r > 0)) break;
    const double seen_at = profile_.elevation(row, found.guess.r);
    const bool close = std::abs(seen_at - elevation) < kClose;
    elevation = seen_at;
    if (close) break;
  }
  return found;
}

RowGuess RowRules::guess_along_row(std::size_t row, double azimuth) const {
  RowGuess found = look_along_row(row, azimuth);
  judge(row, RowSays::all, found);
  return found;
}

double RowRules::range_of_row(std::size_t row, const RowGuess& found,
                              const RowFeatures& asked) const {
  constexpr double kMostChange = 0.1;  // as a share; what changes it by more makes no sense
  const double r = found.guess.r;
  double measured = r + raw_offset_m(found) + profile_.bias_m(row, r);
  if (!profile_.residual.empty()) measured *= 1 + profile_.residual(asked);
  return std::abs(measured - r) <= kMostChange * r ? measured : r;
}

void RowRules::judge(std::size_t row, RowSays says, RowGuess& found) const {
  Guess& guess = found.guess;
  if (!(guess.r > 0)) {
    found.returns = 0;
    return;
  }
  RowFeatures asked{};
  const bool trees = !profile_.returns.empty() || !profile_.residual.empty();
  if (trees) asked = features(row, found);
  found.returns = profile_.returns.empty() ? returns_by_tables(row, found)
                                           : probability_of(profile_.returns(asked));
  if (says == RowSays::all && on_one_surface(guess)) guess.r = range_of_row(row, found, asked);
  guess.seen = found.returns >= 0.5 ? Seen::surface : Seen::nothing;
}

double RowRules::raw_offset_m(const RowGuess& found) const {
  if (offset_m_.empty()) return 0;
  const auto of = [&](const RingLook& ring) {
    return ring.ring >= 0 ? offset_m_[static_cast<std::size_t>(ring.ring)] : 0;
  };
  const double share = found.guess.above_share;
  return (1 - share) * of(found.look.below) + share * of(found.look.above);
}

double RowRules::returns_by_tables(std::size_t row, const RowGuess& found) const {
  // A row that hardly ever returns from there does not now; else it does where the samples on both
  // sides are there, as far as a gap of theirs is not what their rows always have there. Both
  // limits are mapped to one half.
  constexpr double kLeastShare = 0.45, kLeastOccupied = 0.35, kEither = 0.15;
  const double r = found.guess.r;
  const double share = profile_.return_share(row, r);
  if (share < kLeastShare) return 0.5 * share / kLeastShare;
  double there = 0, weight = 0;
  const auto ask = [&](const RingLook& ring, double near) {
    if (ring.ring < 0) return;
    const std::size_t its =
        profile_.given_first + static_cast<std::size_t>(ring.ring) * profile_.given_every;
    if (its >= profile_.rows) return;
    const double says = (near + kEither) * profile_.given_return_share(its, r);
    const Neighbours around = neighbours_of(points_, found.look.line, ring.ring);
    there += says * (0.5 * around.count(1) / 3 + 0.5 * (around.at(0) > 0 ? 1 : 0));
    weight += says;
  };
  ask(found.look.below, 1 - found.look.share);
  ask(found.look.above, found.look.share);
  const double occupied = weight > 0.05 ? there / weight : 0;
  return occupied < kLeastOccupied ? 0.5 * occupied / kLeastOccupied
                                   : 0.5 + 0.5 * (occupied - kLeastOccupied) / (1 - kLeastOccupied);
}

RowRules::Nearest RowRules::nearest_to(double elevation, double range_m) const {
  const auto above_row = [&](std::size_t row) {
    return elevation - profile_.elevation(row, range_m);
  };
  std::size_t nearest = 0;
  for (std::size_t row = 1; row < profile_.rows; ++row) {
    if (std::abs(above_row(row)) < std::abs(above_row(nearest))) nearest = row;
  }
  const double away = above_row(nearest);
  if (profile_.rows < 2) return {nearest, 0};
  // The row on that side; beyond the outermost ones the step is as on the other side.
  const bool up = nearest + 1 >= profile_.rows || (away > 0 && nearest > 0);
  const std::size_t other = up ? nearest - 1 : nearest + 1;
  const double step = std::abs(above_row(other) - away);
  return {nearest, away == 0 ? 0 : std::abs(away) / step};
}

std::optional<NearRow> RowRules::row_near(double elevation, double range_m) const {
  constexpr double kNear = 0.5;
  const Nearest nearest = nearest_to(elevation, range_m);
  if (profile_.is_given(nearest.row) || !(nearest.away <= kNear)) return std::nullopt;
  return NearRow{nearest.row, nearest.away <= kOwn};
}

double RowRules::given_offset_m(double elevation, const RowGuess& found) const {
  const Nearest nearest = nearest_to(elevation, found.guess.r);
  const bool given = profile_.is_given(nearest.row) && nearest.away <= kOwn;
  return given && on_one_surface(found.guess) ? raw_offset_m(found) : 0;
}

}  // namespace curlidar
