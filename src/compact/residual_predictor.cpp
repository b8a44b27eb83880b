// SPDX-License-Identifier: BSD-3-Clause
#include "compact/residual_predictor.hpp"

#include <algorithm>
#include <cstdlib>
#include <span>

#include "entropy/embedded_priors.hpp"
#include "entropy/priors.hpp"

namespace curlidar::compact {
namespace {

constexpr std::size_t kNeighbours = ResidualPredictor::kNeighbours;

struct Offset {
  std::size_t up;
  int right;
};
// W, N, NW, NE, WW, NN, WWW, NWW, NEE, NNW, NNE.
constexpr std::array<Offset, kNeighbours> kOffsets = {
    {{0, -1}, {1, 0}, {1, -1}, {1, 1}, {0, -2}, {2, 0}, {0, -3}, {1, -2}, {1, 2}, {2, -1}, {2, 1}}};
using Weights = std::array<std::int32_t, kNeighbours>;
constexpr Weights kMeanWeights = {8, 8, 4, 4, 3, 3, 0, 0, 0, 0, 0};
constexpr Weights kErrorWeights = {4, 4, 2, 2, 2, 1, 1, 1, 1, 0, 0};
constexpr Weights kLeftWeights = {6, 0, 0, 0, 4, 0, 3, 0, 0, 0, 0};
constexpr Weights kAboveWeights = {0, 6, 4, 4, 0, 2, 0, 2, 2, 1, 1};

constexpr std::int64_t kDampingLength = 6554;  // 0.1 m
constexpr std::int32_t kMaxError = 1 << 20;
constexpr std::int64_t kFilterRate = 4096;
constexpr std::int32_t kMaxFilterWeight = 65536;
constexpr std::int32_t kMaxRowCount = 64;

std::int32_t clamp_range(std::int64_t range) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(range, 1, 1 << 30));
}

/// Within +-limit, which is below 2^31.
std::int32_t clamped(std::int64_t value, std::int64_t limit) {
  return static_cast<std::int32_t>(std::clamp(value, -limit, limit));
}

}  // namespace

ResidualPredictor::ResidualPredictor(std::size_t columns, std::int32_t step)
    : columns_(columns), step_(step), lines_(3 * (columns + 2 * kPad)) {
  usual_error_.fill(1024);
  apply_weight_priors(embedded_priors("residual_filter"), weights_);
}

void ResidualPredictor::start_row() {
  ++row_;
  for (std::size_t column = 0; column < columns_; ++column) cell(0, column).known = false;
  last_row_offset_ = row_offset_;
  row_offset_ = 0;
  row_count_ = 0;
}

void ResidualPredictor::gather(std::size_t column, std::int32_t surface,
                               RangePrediction& prediction) {
  std::array<std::uint32_t, 4> grade{};
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    const auto [up, right] = kOffsets[i];
    const Cell& near =
        cell(up, static_cast<std::size_t>(static_cast<std::ptrdiff_t>(column) + right));
    near_[i] = &near;
    deviation_[i] = 0;
    if (!near.known) continue;
    const std::int32_t offset = (up > 0 ? row_offset_ : 0) + (up > 1 ? last_row_offset_ : 0);
    deviation_[i] = clamped(std::int64_t{near.deviation} + offset, 1 << 30);
    if (i < grade.size()) grade[i] = near.surface == surface ? 2 : 1;
  }
  filter_set_ = 0;
  for (std::size_t i = 0; i < grade.size(); ++i) {
    filter_set_ += (std::size_t{grade[i] >> 1} << i) * kNeighbours;
  }
  prediction.grade_left = grade[0];
  prediction.grade_above = grade[1];
  prediction.last_error_left = grade[0] ? near_[0]->error[kGuesses] : 0;
  prediction.last_error_above = grade[1] ? near_[1]->error[kGuesses] : 0;
}

void ResidualPredictor::measure_spreads(RangePrediction& prediction) const {
  for (std::size_t k = 0; k <= kGuesses; ++k) {
    const std::int64_t most = 3 * std::int64_t{usual_error_[k]} + step_;
    std::int64_t sum = 2 * std::int64_t{usual_error_[k]}, weight = 2;
    for (std::size_t i = 0; i < kNeighbours; ++i) {
      if (!near_[i]->known) continue;
      sum += kErrorWeights[i] * std::min<std::int64_t>(near_[i]->error[k], most);
      weight += kErrorWeights[i];
    }
    (k < kGuesses ? prediction.spread[k] : prediction.blend_spread) =
        static_cast<std::int32_t>(sum / weight);
  }
}

std::int32_t ResidualPredictor::damped_mean(std::int32_t surface) const {
  constexpr std::int64_t square = kDampingLength * kDampingLength;
  std::int64_t sum = 0, total = 6 << 12;
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    if (!near_[i]->known || kMeanWeights[i] == 0) continue;
    const std::int64_t deviation = deviation_[i];
    const std::int64_t trust = kMeanWeights[i] * (near_[i]->surface == surface ? 6 : 3);
    const std::int64_t weight = (trust << 10) * square / (square + deviation * deviation);
    sum += weight * deviation;
    total += weight;
  }
  return static_cast<std::int32_t>(sum / total);
}

std::int32_t ResidualPredictor::weighted(const Weights& weights) const {
  std::int64_t sum = 0, total = 4;
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    if (!near_[i]->known) continue;
    sum += std::int64_t{weights[i]} * input_[i];
    total += weights[i];
  }
  return centre_ + static_cast<std::int32_t>(sum / total);
}

std::int32_t ResidualPredictor::filtered() const {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    sum += std::int64_t{weights_[filter_set_ + i]} * input_[i];
  }
  return centre_ + static_cast<std::int32_t>(sum >> 16);
}

/// Normalised least mean squares (N. Nagumo and A. Noda, 1967), outliers clipped.
void ResidualPredictor::teach_filter(std::int32_t deviation) {
  const std::int64_t error = clamped(std::int64_t{deviation} - filtered(), clip_);
  std::int64_t energy = 1 + std::int64_t{clip_} * clip_;
  for (const std::int64_t input : input_) energy += input * input;
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    std::int32_t& weight = weights_[filter_set_ + i];
    weight += static_cast<std::int32_t>(error * input_[i] * kFilterRate / energy);
    weight = std::clamp(weight, -kMaxFilterWeight, kMaxFilterWeight);
  }
}

void ResidualPredictor::teach_row_offset(std::int32_t deviation, std::int32_t spread) {
  bool seen = false;
  for (std::size_t i = 0; i < kNeighbours; ++i) seen |= kOffsets[i].up > 0 && near_[i]->known;
  if (!seen) return;
  const std::int64_t limit = 2 * std::int64_t{spread} + step_;
  const std::int32_t offset = clamped(std::int64_t{deviation} - above_ + row_offset_, limit);
  row_count_ = std::min(row_count_ + 1, kMaxRowCount);
  row_offset_ += (offset - row_offset_) / (row_count_ + 4);
}

std::int32_t ResidualPredictor::texture(std::int32_t field) const {
  const Cell &w = *near_[0], &n = *near_[1], &nw = *near_[2];
  if (!w.known && !n.known) return field;
  if (!w.known) return n.range;
  if (!n.known) return w.range;
  if (!nw.known) return static_cast<std::int32_t>((std::int64_t{w.range} + n.range) / 2);
  const std::int64_t slope = std::int64_t{w.range} + n.range - nw.range;
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(slope, std::min(w.range, n.range), std::max(w.range, n.range)));
}

std::int32_t ResidualPredictor::blend(const RangePrediction& prediction) const {
  std::array<std::int64_t, kGuesses> spread;
  for (std::size_t k = 0; k < kGuesses; ++k) spread[k] = prediction.spread[k] + step_ / 4 + 1;
  const std::int64_t least = *std::min_element(spread.begin(), spread.end());
  // Weights fall with the eighth power of the spread: nearly the best guess alone.
  std::int64_t sum = 0, total = 0;
  for (std::size_t k = 0; k < kGuesses; ++k) {
    if (k == static_cast<std::size_t>(Guess::mean)) continue;
    std::int64_t weight = (least << 10) / spread[k];
    weight *= weight;
    weight = weight * weight >> 20;
    weight = weight * weight >> 20;
    sum += weight * (prediction.guess[k] - prediction.of(Guess::mean));
    total += weight;
  }
  return clamp_range(prediction.of(Guess::mean) + (total > 0 ? sum / total : 0));
}

void ResidualPredictor::predict(std::size_t column, std::int32_t field, std::int32_t surface,
                                RangePrediction& prediction) {
  field_ = field;
  surface_ = surface;
  gather(column, surface, prediction);
  measure_spreads(prediction);
  centre_ = damped_mean(surface);
  clip_ = 2 * prediction.spread_of(Guess::mean) + step_;
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    input_[i] = near_[i]->known ? clamped(deviation_[i] - std::int64_t{centre_}, clip_) : 0;
  }
  above_ = weighted(kAboveWeights);
  const std::int64_t base = field;
  prediction.guess = {field,
                      clamp_range(base + centre_),
                      clamp_range(base + filtered()),
                      clamp_range(base + weighted(kLeftWeights)),
                      clamp_range(base + above_),
                      texture(field)};
  prediction.blend = blend(prediction);
}

void ResidualPredictor::learn(std::size_t column, std::int32_t range,
                              const RangePrediction& prediction) {
  Cell& here = cell(0, column);
  here.known = true;
  here.surface = surface_;
  here.range = range;
  here.deviation = range - field_;
  for (std::size_t k = 0; k <= kGuesses; ++k) {
    const std::int32_t guess = k < kGuesses ? prediction.guess[k] : prediction.blend;
    here.error[k] = std::min(std::abs(range - guess), kMaxError);
    usual_error_[k] += (here.error[k] - usual_error_[k]) / 64;
  }
  teach_filter(here.deviation);
  teach_row_offset(here.deviation, prediction.spread_of(Guess::above));
}

}  // namespace curlidar::compact
