// SPDX-License-Identifier: BSD-3-Clause
#include "dense/dense_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/parallel.hpp"

namespace curlidar {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// The direction made as long as 1, whatever its length.
Vec3 unit(const Vec3& direction) {
  const double most =
      std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  const Vec3 near{direction.x / most, direction.y / most, direction.z / most};
  return near * (1 / norm(near));
}

/// A line of sight that starts where anything is known.
bool is_sight(const Sightline& line) {
  constexpr double kFarthest_m = 1e5;
  const Vec3& o = line.origin;
  const double away = std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)});
  return is_finite(o) && away < kFarthest_m && is_finite(line.direction) &&
         line.direction != Vec3{};
}

/// The line as it crosses the half-plane of an azimuth.
PlaneLine in_plane(const Sightline& line, double azimuth) {
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  return {azimuth,
          {line.origin.x * c + line.origin.y * s, line.origin.z},
          {line.direction.x * c + line.direction.y * s, line.direction.z}};
}

/// Weights of the two samples of a ring.
void add_sources(const RingLook& ring, double share, std::size_t at, Sources& sources) {
  if (!ring.known || share <= 0) return;
  sources.cell[at] = ring.left.point->cell;
  sources.cell[at + 1] = ring.right.point->cell;
  sources.weight[at] = share * (1 - ring.right_weight);
  sources.weight[at + 1] = share * ring.right_weight;
}

}  // namespace

DenseField::DenseField(std::shared_ptr<const Field> field, const DenseSettings& settings)
    : field_(std::move(field)),
      points_(*field_),
      motion_(*field_),
      errors_(errors_of(points_, *field_)),
      rows_of_profile_(settings.rows_of_profile) {
  if (!settings.profile || !check_rows(*settings.profile, points_)) return;
  profile_ = settings.profile;
  if (profile_->rows == 0) return;
  std::vector<double> offset_m;
  for (std::size_t ring = 0; ring < points_.rings(); ++ring) {
    offset_m.push_back(field_->ring_offset_m(points_.row(ring)));
  }
  rows_.emplace(points_, *profile_, errors_, std::move(offset_m));
}

DenseField::Found DenseField::find_in_plane(const PlaneLine& line) const {
  Found found;
  found.look = look_along(points_, line);
  found.guess = decide(points_, found.look);
  return found;
}

Sightline DenseField::own_line(const Sightline& line, double azimuth) const {
  if (!motion_.moves()) return line;
  const RigidMotion motion = motion_.at(azimuth);
  return {motion.undo(line.origin), motion.turned_back(line.direction)};
}

double DenseField::azimuth_at(const Sightline& line, double range_m, double azimuth) const {
  // Scans turn far faster than they move: each step leaves a hundredth of the error or less.
  constexpr int kSteps = 3;
  const int steps = motion_.moves() ? kSteps : 1;
  for (int step = 0; step < steps; ++step) {
    const Sightline own = own_line(line, azimuth);
    azimuth = azimuth_of(own.origin + own.direction * range_m);
  }
  return azimuth;
}

DenseField::Found DenseField::find(const Sightline& line) const {
  // The half-plane is that of the point, which is not known before it is found; where lines leave
  // from the spin axis and nothing moves it is that of the direction.
  constexpr int kPasses = 5;
  constexpr double kClose = 1e-7;      // radians
  constexpr double kSomewhere_m = 20;  // where nothing is found
  double azimuth = azimuth_of(line.direction);
  const bool straight = !motion_.moves() && line.origin.x == 0 && line.origin.y == 0;
  if (straight) return find_in_plane(in_plane(line, azimuth));
  azimuth = azimuth_at(line, kSomewhere_m, azimuth);
  Found found;
  for (int pass = 0; pass < kPasses; ++pass) {
    found = find_in_plane(in_plane(own_line(line, azimuth), azimuth));
    const double r = found.guess.r > 0 ? found.guess.r : kSomewhere_m;
    const double seen = azimuth_at(line, r, azimuth);
    const bool close = std::abs(turn_between(azimuth, seen)) < kClose;
    azimuth = seen;
    if (close) break;
  }
  return found;
}

RangeEstimate DenseField::estimate(const Sightline& line, bool confident) const {
  RangeEstimate estimate;
  if (confident) estimate.confidence = 0;
  if (!is_sight(line) || points_.empty()) return estimate;
  const Found found = find({line.origin, unit(line.direction)});
  const Verdict verdict = judge(found);
  if (confident) estimate.confidence = confidence_of(found, verdict);
  if (verdict.guess.r > 0) estimate.range_m = verdict.guess.r;
  estimate.seen = verdict.guess.seen;
  return estimate;
}

DenseField::Verdict DenseField::as_given(Verdict rules, double elevation,
                                         const Found& found) const {
  rules.guess.r += rows_->given_offset_m(elevation, {found.look, found.guess});
  return rules;
}

DenseField::Verdict DenseField::judge(const Found& found) const {
  const Verdict rules{found.guess, 1, std::nullopt};
  if (!rows_ || !(found.guess.r > 0)) return rules;
  const PlaneLine& line = found.look.line;
  const double rho = line.from.rho + found.guess.r * line.along.rho;
  const double z = line.from.z + found.guess.r * line.along.z;
  const double elevation = std::atan2(z, rho);
  const auto near = rows_->row_near(elevation, std::hypot(rho, z));
  if (!near) return rows_of_profile_ ? as_given(rules, elevation, found) : rules;
  const bool own = rows_of_profile_ && near->own;
  RowGuess judged{found.look, found.guess};
  rows_->judge(near->row, own ? RowSays::all : RowSays::returns, judged);
  return {judged.guess, judged.returns, own ? std::optional(near->row) : std::nullopt};
}

PlainFeatures DenseField::features(const Found& found) const {
  return plain_features(points_, found.look, found.guess, errors_);
}

RowFeatures DenseField::features(const Found& found, std::size_t row) const {
  return rows_->features(row, {found.look, found.guess});
}

float DenseField::confidence_of(const Found& found, const Verdict& verdict) const {
  if (!(found.guess.r > 0)) return 0;
  if (verdict.row && !profile_->row_confidence.empty()) {
    const RowFeatures asked = features(found, *verdict.row);
    return static_cast<float>(probability_of(profile_->row_confidence(asked)));
  }
  const bool own = profile_ && !profile_->confidence.empty();
  const ObliviousTrees& trees = own ? profile_->confidence : generic_confidence();
  // Trees were taught by steps up to this; the larger one is, the less often a surface that it
  // rounds lies within 5 cm. Large patches lose less: hence the root.
  constexpr double kTaughtStep_m = 0.6;
  const double coarse = std::sqrt(std::max(errors_.step_m / kTaughtStep_m, 1.0));
  // That a surface is there the trees have a say in too: what the profile knows is a limit to it.
  return static_cast<float>(
      std::min(probability_of(trees(features(found))) / coarse, verdict.returns));
}

void DenseField::estimate_all(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                              bool confident, std::size_t threads) const {
  constexpr std::size_t kChunk = 4096;
  parallel_for((lines.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    const std::size_t end = std::min(lines.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) estimates[i] = estimate(lines[i], confident);
  });
}

void DenseField::range_along(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                             std::size_t threads) const {
  estimate_all(lines, estimates, true, threads);
}

void DenseField::surfaces_along(std::span<const Sightline> lines,
                                std::span<RangeEstimate> estimates, std::size_t threads) const {
  estimate_all(lines, estimates, false, threads);
}

double DenseField::along_row(const RowLine& row, PlaneLine line, double column, bool masked) const {
  if (!std::isfinite(column)) return kNan;
  line.azimuth =
      std::remainder(lattice().azimuth(lattice().within_turn(column)), 2 * std::numbers::pi);
  const Guess guess = judge(find_in_plane(line)).guess;
  if (!(guess.r > 0) || (masked && guess.seen != Seen::surface)) return kNan;
  return row.range_of(guess.r * line.along.rho, row.height_m + guess.r * line.along.z);
}

void DenseField::evaluate_row(double row, std::span<const double> columns, bool masked,
                              std::span<double> ranges) const {
  if (points_.empty()) return field_->evaluate_row(row, columns, masked, ranges);
  if (!std::isfinite(row)) return std::fill(ranges.begin(), ranges.end(), kNan);
  const RowLine line = field_->row_line(row);
  const PlaneLine plane{
      0, {0, line.height_m}, {std::cos(line.elevation), std::sin(line.elevation)}};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    ranges[i] = along_row(line, plane, columns[i], masked);
  }
}

Sources DenseField::sources_at(const Vec3& point) const {
  Sources sources;
  if (!is_sight({{}, point}) || points_.empty()) return sources;
  const Found found = find({{}, unit(point)});
  add_sources(found.look.above, found.guess.above_share, 0, sources);
  add_sources(found.look.below, 1 - found.guess.above_share, 2, sources);
  return sources;
}

Status check_density_profile(const DensityProfile& profile, const Field& field) {
  return check_rows(profile, RingPoints(field));
}

std::shared_ptr<const Field> dense_field(std::shared_ptr<const Field> field,
                                         const DenseSettings& settings) {
  if (settings.strategy == DenseStrategy::masks) return field;
  return std::make_shared<DenseField>(std::move(field), settings);
}

}  // namespace curlidar
