// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_report.hpp"

#include <algorithm>

#include "format/container.hpp"

namespace curlidar {
namespace {

CompactStatistics statistics_of(const compact::EncodeStatistics& s) {
  CompactStatistics out;
  out.leaves = s.leaves;
  out.leaves_with_residual = s.leaves_with_residual;
  out.leaves_by_size.assign(s.leaves_by_size.begin(), s.leaves_by_size.end());
  out.leaves_by_layers.assign(s.leaves_by_layers.begin(), s.leaves_by_layers.end());
  out.layers_by_functions.assign(s.layers_by_functions.begin(), s.layers_by_functions.end());
  out.inherited_layers = s.inherited_layers;
  return out;
}

CompactBreakdown breakdown_of(const compact::Breakdown& b) {
  constexpr double kEndChunkSize = 6;
  constexpr double kContainerBits = 8.0 * (kHeaderSize + kEndChunkSize);
  return {b.header + kContainerBits,
          b.mask,
          b.partition,
          b.modes,
          b.coefficients,
          b.labels,
          b.residual,
          0};
}

}  // namespace

CompactReport report_of(const CompactTrial& trial, const GriddedScan& scan,
                        const CompactModel& model, const OwnErrors& errors) {
  CompactReport report;
  report.mean_error_m = errors.mean;
  report.rms_error_m = errors.rms;
  report.max_error_m = errors.max;
  report.bits_per_point_coded = trial.bits_per_point;
  report.step_m = static_cast<double>(trial.steps.step) / compact::kRangeUnit;
  report.residual_step_m = static_cast<double>(trial.steps.residual_step) / compact::kRangeUnit;
  report.rows = scan.rows;
  report.columns = scan.columns;
  report.segments = static_cast<std::uint32_t>(
      std::count_if(trial.encoded.chunks.begin(), trial.encoded.chunks.end(),
                    [](const auto& chunk) { return chunk.part == compact::ScanPart::field; }));
  report.cell_centres = scan.cell_centres;
  report.heights = !model.table.height.empty();
  report.range_offsets = !model.table.range_offset.empty();
  report.encodings = trial.encodings;
  report.breakdown = breakdown_of(trial.encoded.breakdown);
  report.statistics = statistics_of(trial.encoded.statistics);
  return report;
}

}  // namespace curlidar
