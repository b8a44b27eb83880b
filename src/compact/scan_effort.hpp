// SPDX-License-Identifier: BSD-3-Clause
// How settings that people understand become settings of the coder: where to tune.
#pragma once

#include <cstdint>
#include <vector>

#include "compact/field_search.hpp"

namespace curlidar::compact {

inline constexpr std::uint32_t kLeastEffort = 1, kMostEffort = 9, kDefaultEffort = 4;

/// The Lagrangian: what a bit is worth, in thousandths of the step of the finest layer.
inline constexpr std::uint32_t kLambdaPerMille = 170;

/// How hard an encoder searches.
struct Effort {
  SearchSettings search;
  bool thorough_mask = false;
  /// Of the residual layer: what a bit is worth, Q16 metres, and residual_cost_table.
  std::int64_t residual_lambda = 0;
  std::vector<std::int64_t> residual_costs;
  std::int32_t max_error = 0;  ///< of a range, Q16 metres; 0 = any
};

/// The search for an effort of 1..9 (clamped). `residual_step` 0: no residual layer follows.
Effort search_settings(std::uint32_t effort, std::int32_t step, std::int32_t residual_step,
                       std::uint32_t lambda_per_mille = kLambdaPerMille);

/// Cost of a cell's error under a residual layer, in Q16 metres / 256, by error * 8 /
/// residual_step: the least over q of |error - q step| plus lambda (Q16 metres a bit) times the
/// usual bits of q. Above the last entry it hardly grows.
std::vector<std::int64_t> residual_cost_table(std::int32_t residual_step, std::int64_t lambda);

/// Steps of field and residual layer.
struct Steps {
  std::int32_t step = 0;
  std::int32_t residual_step = 0;
  std::uint64_t lattice_q32 = 0;  ///< if not 0, in place of residual_step
  std::uint32_t root_log2 = 4;
  std::uint32_t smallest_leaf = 8;
};

/// Below this mean error (Q16 metres) a coarse field under fine residuals is the best.
inline constexpr std::int64_t kCoarseFieldBelow = 7 * kRangeUnit / 1000;

/// The step of such a field: coarse enough to cost little, fine enough to tell surfaces apart. Any
/// from .3 to .8 m is within 2 %, the best one depends on the scene.
inline constexpr std::int32_t kCoarseStep = kRangeUnit / 2;

/// What a field does under residuals.
enum class FieldKind : std::uint8_t {
  by_error,  ///< as is mostly best for the wanted error
  close,     ///< it has the residuals' step, which are for what it cannot say
  coarse,    ///< it predicts for fine residuals everywhere
};

/// Steps that give about the wanted mean error (Q16 metres), times `scale_q16` / 65536: the codec
/// searches over the scale, in which the reached error rises monotonically but for noise. Three
/// regimes: a coarse field under fine residuals, where `kind` asks for it; else field and residuals
/// of one step; a field without residuals where that step is wide.
Steps steps_for_error(std::int64_t mean_error, std::int64_t scale_q16 = 65536,
                      FieldKind kind = FieldKind::by_error);

/// Steps for a given D: no residual layer.
Steps steps_for_step(std::int32_t step);

}  // namespace curlidar::compact
