// SPDX-License-Identifier: BSD-3-Clause
#include "compact/scan_effort.hpp"

#include <gtest/gtest.h>

namespace curlidar::compact {
namespace {

TEST(ScanEffort, StepsGrowWithTheScale) {
  for (const double error_m : {1e-4, .002, .0089, .0091, .01, .029, .031, .05, .5}) {
    const auto error = static_cast<std::int64_t>(error_m * 65536);
    Steps last = steps_for_error(error, 1);
    for (std::int64_t scale = 64; scale <= 1 << 22; scale *= 2) {
      const Steps steps = steps_for_error(error, scale);
      EXPECT_GE(steps.step, last.step);
      EXPECT_GE(steps.step, 1);
      // A wide step needs no residuals; from there on there are none.
      if (steps.residual_step == 0) {
        EXPECT_GT(steps.step, kRangeUnit / 4);
      } else {
        EXPECT_GE(steps.residual_step, last.residual_step);
        EXPECT_GT(last.residual_step, 0);
      }
      last = steps;
    }
    EXPECT_GT(last.step + last.residual_step,
              steps_for_error(error, 1).step + steps_for_error(error, 1).residual_step);
  }
}

TEST(ScanEffort, ResidualCostsGrowWithTheError) {
  for (const std::int32_t step : {1, 13, 650, 32768}) {
    const std::int64_t lambda = std::max(1, step / 6);
    const auto costs = residual_cost_table(step, lambda);
    // An error that rounds away costs itself and the usual bits of nothing, at most two.
    EXPECT_LE(costs[0], std::int64_t{step} * 16 + lambda * 512 + 256);
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const std::int64_t error = static_cast<std::int64_t>(2 * i + 1) * step / 16;
      EXPECT_GT(costs[i], 0);
      EXPECT_LE(costs[i], error * 256 + lambda * 512);
      EXPECT_LE(costs[i], std::int64_t{step} * 128 + lambda * (640 + 512 * 16) + 256);
    }
    EXPECT_GT(costs.back(), costs.front());
  }
}

TEST(ScanEffort, MoreEffortNeverSearchesLess) {
  for (std::uint32_t effort = 2; effort <= 9; ++effort) {
    const Effort less = search_settings(effort - 1, 3277, 0),
                 more = search_settings(effort, 3277, 0);
    EXPECT_GE(more.search.max_layers, less.search.max_layers);
    EXPECT_GE(more.search.max_functions, less.search.max_functions);
    EXPECT_EQ(more.search.lambda, less.search.lambda);
    EXPECT_TRUE(more.search.residual_costs.empty());
  }
  EXPECT_EQ(search_settings(0, 3277, 0).search.max_layers,
            search_settings(1, 3277, 0).search.max_layers);
  EXPECT_EQ(search_settings(99, 3277, 0).search.fitted_parents,
            search_settings(9, 3277, 0).search.fitted_parents);
}

}  // namespace
}  // namespace curlidar::compact
