// SPDX-License-Identifier: BSD-3-Clause
#include "compact/scan_effort.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "compact/scan_types.hpp"

namespace curlidar::compact {
namespace {

struct EffortRow {
  std::uint32_t max_layers, max_functions, fitted_parents, reweighted_passes, layer_passes;
  std::uint32_t binary_below;
};

constexpr std::array<EffortRow, kMostEffort> kEfforts = {{
    {2, 2, 1, 0, 1, 1},
    {3, 3, 1, 1, 1, 1},
    {3, 3, 2, 1, 2, 1},
    {4, 3, 2, 1, 2, 1},
    {4, 3, 2, 1, 2, 16},
    {4, 3, 2, 2, 2, 16},
    {4, 3, 3, 2, 3, 16},
    {4, 3, 3, 2, 3, 32},
    {4, 3, 5, 2, 3, 32},
}};

constexpr std::int64_t kCoarseRatio = 4;
/// From this step on hardly a leaf wants residuals.
constexpr std::int32_t kFieldAloneStep = 42 * kRangeUnit / 100;
/// Mean errors that mostly need such steps.
constexpr std::int64_t kUsuallyFieldAlone = 3 * kRangeUnit / 100;
constexpr std::int64_t kCostEntries = 8 * 4096;

std::int32_t step_of(std::int64_t mean_error, std::int64_t factor_per_mille,
                     std::int64_t scale_q16) {
  const std::int64_t unscaled = std::min<std::int64_t>(mean_error, kMaxRange) * factor_per_mille;
  const std::int64_t scale = std::clamp<std::int64_t>(scale_q16, 1, 1 << 26);
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(mul_shift(unscaled, scale, 16) / 1000, 1, kMaxStep));
}

/// What a bit of the residual layer is worth against one of the field: residuals are chosen one by
/// one with the costs they have, and save less elsewhere.
constexpr std::int64_t kResidualBitPerMille = 1180;

/// Usual bits of q under a residual layer, 1/256 bit: zero 1.6, one 2.2, then Exp-Golomb.
std::int64_t usual_bits(std::int64_t q) {
  if (q == 0) return 410;
  return 563 + 512 * (std::bit_width(static_cast<std::uint64_t>(q)) - 1);
}

}  // namespace

Effort search_settings(std::uint32_t effort, std::int32_t step, std::int32_t residual_step,
                       std::uint32_t lambda_per_mille) {
  const EffortRow& row = kEfforts[std::clamp(effort, kLeastEffort, kMostEffort) - 1];
  Effort out;
  out.thorough_mask = effort >= 5;
  SearchSettings& s = out.search;
  s.max_layers = row.max_layers;
  s.max_functions = row.max_functions;
  s.fitted_parents = row.fitted_parents;
  s.reweighted_passes = row.reweighted_passes;
  s.layer_passes = row.layer_passes;
  s.binary_below = row.binary_below;
  const auto lambda_of = [&](std::int64_t of_step) {
    return std::max<std::int64_t>(1, of_step * lambda_per_mille / 1000);
  };
  s.lambda = lambda_of(step);
  if (residual_step == 0) return out;
  out.residual_lambda = lambda_of(residual_step) * kResidualBitPerMille / 1000;
  out.residual_costs = residual_cost_table(residual_step, out.residual_lambda);
  // Under much finer residuals, which predict from their neighbours, the field need not know.
  if (step > kCoarseRatio * residual_step) return out;
  s.lambda = std::min(s.lambda, out.residual_lambda);
  s.residual_step = residual_step;
  s.residual_costs = out.residual_costs;
  return out;
}

std::vector<std::int64_t> residual_cost_table(std::int32_t residual_step, std::int64_t lambda) {
  std::vector<std::int64_t> costs;
  costs.reserve(kCostEntries);
  for (std::int64_t i = 0; i < kCostEntries; ++i) {
    const std::int64_t error = (2 * i + 1) * residual_step / 16;
    const std::int64_t nearest = (2 * error + residual_step) / (2 * residual_step);
    std::int64_t least = INT64_MAX;
    for (const std::int64_t q : {nearest, nearest - 1, std::int64_t{0}}) {
      if (q < 0) continue;
      const std::int64_t left = error - q * residual_step;
      least = std::min(least, (left < 0 ? -left : left) * 256 + lambda * usual_bits(q));
    }
    costs.push_back(least);
  }
  return costs;
}

Steps steps_for_error(std::int64_t mean_error, std::int64_t scale_q16, FieldKind kind) {
  Steps steps;
  if (kind == FieldKind::by_error) {
    kind = mean_error < kCoarseFieldBelow ? FieldKind::coarse : FieldKind::close;
  }
  if (kind == FieldKind::close) {
    steps.step = step_of(mean_error, mean_error >= kUsuallyFieldAlone ? 9000 : 4400, scale_q16);
    steps.residual_step = steps.step < kFieldAloneStep ? steps.step : 0;
    return steps;
  }
  steps.step = kCoarseStep;
  steps.residual_step = step_of(mean_error, 3700, scale_q16);
  return steps;
}

Steps steps_for_step(std::int32_t step) {
  Steps steps;
  steps.step = step;
  return steps;
}

}  // namespace curlidar::compact
