// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_tuning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/try.hpp"

namespace curlidar {
namespace {

/// Median of what the returns of each row lie farther than a field without residuals has them,
/// metres.
Result<std::vector<double>> row_medians(const CompactJob& job) {
  // Coarse enough to see through noise, fine enough to follow the scene.
  constexpr std::int32_t kStep = 3 * compact::kRangeUnit / 10;
  CURLIDAR_TRY_ASSIGN(trial, try_steps(job, compact::steps_for_step(kStep), kQuickEffort));
  const compact::Image& decoded = trial.encoded.decoded;
  std::vector<double> medians;
  std::vector<std::int32_t> gaps;
  std::size_t cell = 0;
  for (std::uint32_t row = 0; row < decoded.rows; ++row) {
    gaps.clear();
    for (std::uint32_t column = 0; column < decoded.columns; ++column, ++cell) {
      if (decoded.range[cell] > 0) {
        gaps.push_back(job.model.image.range[cell] - decoded.range[cell]);
      }
    }
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::nth_element(gaps.begin(), middle, gaps.end());
    medians.push_back(gaps.empty() ? 0 : static_cast<double>(*middle) / compact::kRangeUnit);
  }
  return medians;
}

/// Times that what a field says of the offsets is added: it is better than what three rows at a
/// time do.
std::uint32_t offset_rounds(std::uint32_t effort) {
  return effort < 4 ? 1 : 2;
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

}  // namespace

Status choose_range_offsets(CompactJob& job, std::vector<double> offsets, double error_m,
                            CompactModel& model) {
  CompactModel tried = model;
  set_range_offsets(tried.table, offsets, error_m);
  if (job.settings.effort < kQuickEffort) {
    // No time to try.
    if (root_mean_square(offsets) > error_m / 4) model = std::move(tried);
    return {};
  }
  const CompactJob other{job.cloud, job.scan, tried, job.settings, job.threads, {}};
  for (std::uint32_t round = 0; round < offset_rounds(job.settings.effort); ++round) {
    CURLIDAR_TRY_ASSIGN(medians, row_medians(other));
    for (std::size_t row = 0; row < offsets.size(); ++row) offsets[row] += medians[row];
    set_range_offsets(tried.table, offsets, error_m);
  }
  const compact::Steps steps = usual_steps(job);
  CURLIDAR_TRY_ASSIGN(plain, try_steps(job, steps, kQuickEffort));
  job.start = start_after(plain, job.settings, kQuickEffort);
  if (tried.table.range_offset.empty()) return {};
  CURLIDAR_TRY_ASSIGN(moved, try_steps(other, steps, kQuickEffort));
  if (!is_cheaper(moved, plain)) return {};
  job.start = start_after(moved, job.settings, kQuickEffort);
  model.table = tried.table;
  return {};
}

}  // namespace curlidar
