// SPDX-License-Identifier: BSD-3-Clause
#include "compact/residual_predictor.hpp"

#include <algorithm>
#include <cstdlib>

namespace curlidar {
namespace {

struct Offset {
  std::size_t up;
  int right;
};
// W, N, NW, NE first: contexts look at these.
constexpr std::array<Offset, 11> kOffsets = {
    {{0, -1}, {1, 0}, {1, -1}, {1, 1}, {0, -2}, {2, 0}, {0, -3}, {1, -2}, {1, 2}, {2, -1}, {2, 1}}};
constexpr std::array<std::int32_t, 11> kMeanWeights = {8, 8, 4, 4, 3, 3, 2, 2, 2, 1, 1};
constexpr std::array<std::int32_t, 11> kErrorWeights = {4, 4, 2, 2, 2, 1, 1, 1, 1, 0, 0};

constexpr std::int32_t kMaxError = 1 << 20;
constexpr std::int32_t kMaxRange = 1 << 30;

std::int32_t clamp_range(std::int64_t range) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(range, 1, kMaxRange));
}

}  // namespace

ResidualPredictor::ResidualPredictor(std::size_t columns, std::int32_t step)
    : columns_(columns), step_(step), lines_(3 * (columns + 2 * kPad)) {
  usual_error_.fill(1024);
  weights_.fill(0);
}

void ResidualPredictor::start_row() {
  ++row_;
  for (std::size_t column = 0; column < columns_; ++column) cell(0, column).known = false;
  row_offset_ = 0;
  row_count_ = 0;
}

void ResidualPredictor::gather(std::size_t column) {
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    near_[i] = &cell(kOffsets[i].up, static_cast<std::size_t>(static_cast<std::ptrdiff_t>(column) +
                                                              kOffsets[i].right));
  }
}

void ResidualPredictor::measure_spreads(RangePrediction& prediction) const {
  for (std::size_t k = 0; k <= kResidualPredictors; ++k) {
    std::int64_t sum = 2 * usual_error_[k], weight = 2;
    for (std::size_t i = 0; i < 9; ++i) {
      if (!near_[i]->known) continue;
      sum += static_cast<std::int64_t>(kErrorWeights[i]) * near_[i]->error[k];
      weight += kErrorWeights[i];
    }
    const auto mean = static_cast<std::int32_t>(sum / weight);
    if (k < kResidualPredictors) {
      prediction.each_spread[k] = mean;
    } else {
      prediction.spread = mean;
    }
  }
}

std::int32_t ResidualPredictor::damped_mean(std::int32_t surface) const {
  const std::int64_t limit = 6554;
  const std::int64_t limit2 = limit * limit;
  std::int64_t sum = 0, weight = 12 << 12;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!near_[i]->known) continue;
    const std::int64_t deviation = near_[i]->deviation;
    const std::int64_t base = kMeanWeights[i] * (near_[i]->surface == surface ? 6 : 3);
    const std::int64_t w = (base << 12) / 4 * limit2 / (limit2 + deviation * deviation);
    sum += w * deviation;
    weight += w;
  }
  return static_cast<std::int32_t>(sum / weight);
}

std::int32_t ResidualPredictor::filtered(std::int32_t centre, std::int32_t spread) {
  centre_ = centre;
  clip_ = 3 * spread + step_;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    inputs_[i] = near_[i]->known ? std::clamp(near_[i]->deviation - centre, -clip_, clip_) : 0;
    sum += static_cast<std::int64_t>(weights_[i]) * inputs_[i];
  }
  return static_cast<std::int32_t>(centre + (sum >> 16));
}

void ResidualPredictor::teach_filter(std::int32_t deviation) {
  std::int64_t sum = 0, energy = 1 + static_cast<std::int64_t>(clip_) * clip_;
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    sum += static_cast<std::int64_t>(weights_[i]) * inputs_[i];
    energy += static_cast<std::int64_t>(inputs_[i]) * inputs_[i];
  }
  const std::int64_t error =
      std::clamp<std::int64_t>(deviation - centre_ - (sum >> 16), -clip_, clip_);
  // energy < 2^47; the step is rate * error * input / energy, 1 = 65536.
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    weights_[i] = std::clamp(
        weights_[i] + static_cast<std::int32_t>(error * inputs_[i] * 2048 / energy), -65536, 65536);
  }
}

std::int32_t ResidualPredictor::texture(std::int32_t field) const {
  const Cell &w = *near_[0], &n = *near_[1], &nw = *near_[2];
  if (!w.known && !n.known) return field;
  if (!w.known) return n.range;
  if (!n.known) return w.range;
  if (!nw.known)
    return static_cast<std::int32_t>((static_cast<std::int64_t>(w.range) + n.range) / 2);
  const std::int64_t low = std::min(w.range, n.range), high = std::max(w.range, n.range);
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(static_cast<std::int64_t>(w.range) + n.range - nw.range, low, high));
}

void ResidualPredictor::blend(RangePrediction& prediction) const {
  std::array<std::int64_t, kResidualPredictors> spread;
  for (std::size_t k = 0; k < kResidualPredictors; ++k) {
    spread[k] = prediction.each_spread[k] + step_ / 4 + 1;
  }
  const std::int64_t least = *std::min_element(spread.begin(), spread.end());
  std::int64_t sum = 0, total = 0;
  for (std::size_t k = 0; k < kResidualPredictors; ++k) {
    const std::int64_t ratio = (least << 10) / spread[k];
    sum += ratio * ratio * (prediction.each[k] - prediction.each[1]);
    total += ratio * ratio;
  }
  prediction.range = clamp_range(prediction.each[1] + sum / total);
}

void ResidualPredictor::predict(std::size_t column, std::int32_t field, std::int32_t surface,
                                RangePrediction& prediction) {
  gather(column);
  field_ = field;
  surface_ = surface;
  measure_spreads(prediction);
  const std::int32_t mean = damped_mean(surface);

  std::int64_t left = 0, left_weight = 4, above = 0, above_weight = 4;
  constexpr std::array<std::int32_t, 11> kLeft = {6, 0, 0, 0, 4, 0, 3, 0, 0, 0, 0};
  constexpr std::array<std::int32_t, 11> kAbove = {0, 6, 4, 4, 0, 2, 0, 2, 2, 1, 1};
  for (std::size_t i = 0; i < kNeighbours; ++i) {
    if (!near_[i]->known) continue;
    const std::int32_t limit = 3 * prediction.each_spread[1] + step_;
    const std::int32_t value = std::clamp(near_[i]->deviation - mean, -limit, limit);
    left += static_cast<std::int64_t>(kLeft[i]) * value;
    left_weight += kLeft[i];
    above += static_cast<std::int64_t>(kAbove[i]) * value;
    above_weight += kAbove[i];
  }
  has_upper_ = above_weight > 4;
  upper_ = mean + static_cast<std::int32_t>(above / above_weight);

  prediction.each[0] = field;
  prediction.each[1] = clamp_range(std::int64_t{field} + mean);
  prediction.each[2] = clamp_range(std::int64_t{field} + filtered(mean, prediction.each_spread[1]));
  prediction.each[3] = clamp_range(std::int64_t{field} + mean + left / left_weight);
  prediction.each[4] = clamp_range(std::int64_t{field} + upper_ + row_offset_);
  prediction.each[5] = texture(field);
  blend(prediction);

  prediction.known = prediction.same = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const bool known = near_[i]->known, same = known && near_[i]->surface == surface;
    prediction.known |= static_cast<std::uint32_t>(known) << i;
    prediction.same |= static_cast<std::uint32_t>(same) << i;
    prediction.last_error[i] = known ? near_[i]->error[kResidualPredictors] : 0;
  }
}

void ResidualPredictor::learn(std::size_t column, std::int32_t range,
                              const RangePrediction& prediction) {
  Cell& here = cell(0, column);
  here.known = true;
  here.surface = surface_;
  here.range = range;
  here.deviation = range - field_;
  for (std::size_t k = 0; k <= kResidualPredictors; ++k) {
    const std::int32_t guess = k < kResidualPredictors ? prediction.each[k] : prediction.range;
    const std::int32_t error = std::min(std::abs(range - guess), kMaxError);
    here.error[k] = error;
    usual_error_[k] += (error - usual_error_[k]) / 64;
  }
  teach_filter(here.deviation);
  if (has_upper_) {
    const std::int32_t limit = 3 * prediction.each_spread[4] + step_;
    const auto offset = static_cast<std::int32_t>(
        std::clamp<std::int64_t>(std::int64_t{here.deviation} - upper_, -limit, limit));
    row_count_ = std::min(row_count_ + 1, 64);
    row_offset_ += (offset - row_offset_) / (row_count_ + 4);
  }
}

}  // namespace curlidar
