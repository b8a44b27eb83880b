// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_encode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/stopwatch.hpp"
#include "base/try.hpp"
#include "codec/chosen_attributes.hpp"
#include "codec/compact_decode.hpp"
#include "codec/compact_offsets.hpp"
#include "codec/compact_search.hpp"
#include "image/range_image.hpp"

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
          b.residual};
}

/// The points behind the occupied cells, in raster order.
std::vector<std::uint32_t> coded_points(const GriddedScan& scan) {
  std::vector<std::uint32_t> coded;
  coded.reserve(scan.counts.kept);
  for (const std::uint32_t source : scan.source) {
    if (source != kNoPoint) coded.push_back(source);
  }
  return coded;
}

/// Decodes the file and measures it: what a report says is what a reader gets.
Result<OwnErrors> measure_file(const std::vector<std::byte>& bytes, const Cloud& cloud,
                               const GriddedScan& scan, const compact::Image& expected,
                               std::size_t threads) {
  DecodeOptions options;
  options.threads = threads;
  options.limits = {UINT64_MAX, UINT64_MAX};
  CURLIDAR_TRY_ASSIGN(back, decode_compact_image(bytes, options));
  if (back.image.range != expected.range) {
    return Error{ErrorCode::corrupt,
                 "the file decodes to something else than was encoded, which is a defect of this "
                 "program: please report it with the scan"};
  }
  return own_errors(cloud, scan, back.table, back.image);
}

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

/// Gives the model range offsets if they make the file smaller at the same error, and the job what
/// was learnt about where to start.
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

/// The metadata of a file with any name the sensor, too: rows alone do not tell.
std::map<std::string, std::string> metadata_of(const Cloud& cloud, const GriddedScan& scan) {
  std::map<std::string, std::string> metadata = cloud.metadata;
  if (!metadata.empty() && !scan.cell_centres) metadata.emplace(kSensorKey, scan.sensor);
  return metadata;
}

}  // namespace

Result<Encoded> encode_compact(const Cloud& cloud, const EncodeSettings& settings,
                               const ProgressCallback& progress) {
  CURLIDAR_TRY(validate(settings.compact));
  Stopwatch watch;
  Encoded out;
  EncodeReport& report = out.report;
  CURLIDAR_TRY_ASSIGN(scan, grid_scan(cloud, settings));
  const double error_m = first_error_guess(settings.compact);
  const RowModel rows = fit_rows(cloud, scan, error_m);
  CompactModel model = make_model(scan, rows, error_m);
  report.stages_ms.push_back({"grid", watch.lap_ms()});

  CompactJob job{cloud, scan, model, settings.compact, settings.threads, progress};
  CURLIDAR_TRY(choose_range_offsets(job, estimate_range_offsets(scan, rows), error_m, model));
  report.stages_ms.push_back({"offsets", watch.lap_ms()});
  CURLIDAR_TRY(choose_kind(job));
  CURLIDAR_TRY_ASSIGN(trial, search_target(job));
  report.stages_ms.push_back({"search", watch.lap_ms()});

  ContainerWriter writer;
  for (const compact::ScanChunk& chunk : trial.encoded.chunks) {
    writer.add(static_cast<ChunkType>(chunk.part), chunk.payload);
  }
  CURLIDAR_TRY(add_attributes(cloud, settings.attributes, coded_points(scan), writer));
  CURLIDAR_TRY(add_metadata(metadata_of(cloud, scan), writer));
  out.bytes = std::move(writer).finish();
  report.stages_ms.push_back({"write", watch.lap_ms()});

  CURLIDAR_TRY_ASSIGN(
      errors, measure_file(out.bytes, cloud, scan, trial.encoded.decoded, settings.threads));
  report.compact = report_of(trial, scan, model, errors);
  if (settings.compact.target == CompactTarget::error_nn) {
    report.compact->error_nn_m = trial.error_nn_m;
  }
  report.stages_ms.push_back({"measure", watch.lap_ms()});
  report.sensor = scan.sensor;
  report.points_in = scan.counts.returns;
  report.points_coded = scan.counts.kept;
  report.projection = scan.counts;
  report.bytes = out.bytes.size();
  report.bits_per_point =
      8.0 * static_cast<double>(report.bytes) / static_cast<double>(report.points_in);
  if (progress) progress("write", 1);
  return out;
}

}  // namespace curlidar
