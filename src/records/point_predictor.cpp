// SPDX-License-Identifier: BSD-3-Clause
#include "records/point_predictor.hpp"

#include <algorithm>
#include <cmath>

namespace curlidar::records {
namespace {

/// Points so close before are of the same scan line; those so far before are forgotten.
constexpr std::ptrdiff_t kLeastLag = 8;
constexpr std::ptrdiff_t kMostLag = 4096;
/// The match moves along with the points and is sought near by, and everywhere now and then.
constexpr std::ptrdiff_t kReach = 4;
constexpr std::size_t kEvery = 16;
constexpr double kSlow = 0.99, kFast = 0.95;
constexpr double kForget = 0.125;

double length(const Position& p) {
  return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

/// The point as far away as `of`, in its direction turned as from one point to another.
Position turn(const Position& from, const Position& to, const Position& of) {
  const double start = length(from), end = length(to), range = length(of);
  if (!(start > 0 && end > 0 && range > 0)) return of;
  Position turned;
  for (std::size_t i = 0; i < 3; ++i) {
    turned[i] = range * (of[i] / range + to[i] / end - from[i] / start);
  }
  return turned;
}

/// The value unless it is far beyond any position, or not a number.
double bounded(double value, double otherwise) {
  return std::abs(value) < 0x1p60 ? value : otherwise;
}

/// Moves the point along its ray so that it agrees with the coordinate that tells its range best.
double on_ray(const Position& point, std::size_t axis, const Position& known) {
  if (axis == 0) return point[0];
  const std::size_t by = axis == 2 && std::abs(point[1]) > std::abs(point[0]) ? 1 : 0;
  if (point[by] == 0 || std::abs(point[by]) * 4 < std::abs(point[axis])) return point[axis];
  return bounded(point[axis] * (known[by] / point[by]), point[axis]);
}

double blend(const std::array<double, 3>& guesses, const std::array<double, 3>& misses) {
  double weights = 0, sum = 0;
  for (std::size_t i = 0; i < guesses.size(); ++i) {
    double weight = 1 / (misses[i] + 0.02);
    weight *= weight;
    weight *= weight;
    weight *= weight;
    weights += weight;
    sum += weight * guesses[i];
  }
  return sum / weights;
}

}  // namespace

double PointPredictor::squared_distance(std::ptrdiff_t index) const {
  const Position& a = points_[static_cast<std::size_t>(index)];
  const Position& b = points_.back();
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return x * x + y * y + z * z;
}

void PointPredictor::find_match() {
  const auto size = static_cast<std::ptrdiff_t>(points_.size());
  const std::ptrdiff_t high = size - 1 - kLeastLag;
  if (high < 1) return;
  const std::ptrdiff_t low = std::max<std::ptrdiff_t>(1, size - 1 - kMostLag);
  const bool everywhere = match_ == kNone || points_.size() % kEvery == 0;
  const std::ptrdiff_t expected = match_ == kNone ? high : std::clamp(match_ + 1, low, high);
  const std::ptrdiff_t first = everywhere ? low : std::max(low, expected - kReach);
  const std::ptrdiff_t end = (everywhere ? high : std::min(high, expected + kReach)) + 1;
  match_ = expected;
  // Leaving the line that was followed so far has to pay.
  double least = squared_distance(expected) / 2;
  for (std::ptrdiff_t i = end; i-- > first;) {
    const double distance = squared_distance(i);
    if (distance >= least) continue;
    least = distance;
    match_ = i;
  }
}

void PointPredictor::begin() {
  const std::size_t size = points_.size();
  if (size == 0) return;
  find_match();
  last_ = points_[size - 1];
  second_ = size >= 2 ? points_[size - 2] : last_;
  third_ = size >= 3 ? points_[size - 3] : second_;
  matched_ = next_ = before_ = after_ = beyond_ = turned_ = last_;
  if (match_ != kNone) {
    const auto match = static_cast<std::size_t>(match_);
    matched_ = points_[match];
    next_ = points_[match + 1];
    before_ = points_[match - 1];
    after_ = points_[match + 2];
    const std::ptrdiff_t beyond = matches_[match + 1];
    beyond_ = beyond == kNone ? matched_ : points_[static_cast<std::size_t>(beyond)];
    turned_ = turn(matched_, next_, last_);
  }
  spun_ = turn(beyond_, next_, next_);
}

Guess PointPredictor::guess(std::size_t axis, const Position& known) const {
  Guess g;
  g.last = last_[axis];
  g.parallel = last_[axis] + next_[axis] - matched_[axis];
  g.turned = on_ray(turned_, axis, known);
  g.features = {last_[axis] - second_[axis],
                second_[axis] - third_[axis],
                next_[axis] - matched_[axis],
                before_[axis] - matched_[axis],
                matched_[axis] - last_[axis],
                after_[axis] - next_[axis],
                g.turned - last_[axis],
                axis > 0 ? known[0] - last_[0] : 0,
                axis == 0   ? g.turned - g.parallel
                : axis == 1 ? next_[0] - matched_[0]
                            : known[1] - last_[1],
                next_[axis] - beyond_[axis],
                on_ray(spun_, axis, known) - last_[axis]};
  g.slow = bounded(g.last + slow_[axis].predict(g.features), g.last);
  g.fast = bounded(g.last + fast_[axis].predict(g.features), g.last);
  g.value = blend({g.turned, g.slow, g.fast}, misses_[axis]);
  return g;
}

void PointPredictor::learn(std::size_t axis, const Guess& guess, double value) {
  const std::array<double, 3> guesses = {guess.turned, guess.slow, guess.fast};
  for (std::size_t i = 0; i < guesses.size(); ++i) {
    double& miss = misses_[axis][i];
    miss += (std::abs(guesses[i] - value) - miss) * kForget;
  }
  double& recent = recent_[axis];
  recent += (std::abs(guess.value - value) - recent) * kForget;
  const double miss = value - guess.slow;
  const double weight = 1 / (recent * recent + miss * miss + 0.1);
  slow_[axis].learn(guess.features, value - last_[axis], weight, kSlow);
  fast_[axis].learn(guess.features, value - last_[axis], weight, kFast);
}

void PointPredictor::push(const Position& point, const Position& errors) {
  points_.push_back(point);
  errors_.push_back(errors);
  matches_.push_back(match_ == kNone ? kNone : match_ + 1);
}

double PointPredictor::matched_error(std::size_t axis) const {
  if (match_ == kNone) return recent_[axis];
  const auto match = static_cast<std::size_t>(match_);
  return (errors_[match + 1][axis] * 2 + errors_[match][axis] + errors_[match - 1][axis]) / 4;
}

}  // namespace curlidar::records
