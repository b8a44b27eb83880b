// SPDX-License-Identifier: BSD-3-Clause
#include "codec/record_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "base/try.hpp"
#include "codec/beam_tables.hpp"
#include "codec/compact_offsets.hpp"
#include "codec/compact_tuning.hpp"
#include "image/range_image.hpp"

namespace curlidar {
namespace {

/// Without a unit of ranges known, coordinates are finest brought back from here.
constexpr double kExactStep_m = 0.001;
/// Of a bound that offsets of directions may take: half a step either way in two directions.
constexpr double kBoundOfOffsets = 0.8;

double step_of_offsets(const CompactSettings& settings, double error_m) {
  if (settings.target == CompactTarget::lossless) return kExactStep_m;
  if (settings.target == CompactTarget::max_error) return kBoundOfOffsets * settings.target_value;
  return error_m;
}

/// Where the ranges of a lattice begin for the estimate of offsets.
RowModel rows_of(const RecordLayout& layout, const CompactModel& model, const Cloud& cloud,
                 double error_m) {
  if (!layout.lattice) return fit_rows(cloud, layout.scan, error_m);
  RowModel rows{layout.scan.elevations, {}};
  for (const compact::Ray& ray : model.table.rays->rays) {
    rows.height.push_back(static_cast<double>(ray.height) / compact::kRangeUnit);
  }
  return rows;
}

/// Distance of the returns from their rays or rounded offsets that all but one in a thousand keep
/// within, metres.
double usual_distance_beside(const Cloud& cloud, const GriddedScan& scan,
                             const CompactModel& model) {
  const std::vector<Vec3> points = points_of(model, model.image);
  std::vector<double> distances;
  for (const std::uint32_t source : scan.source) {
    if (source != kNoPoint) {
      distances.push_back(norm(points[distances.size()] - cloud.positions[source]));
    }
  }
  return percentile(distances, 0.999);
}

/// Encodes at each of the steps with the effort of quick trials, and then at the best.
Result<CompactTrial> best_of(const CompactJob& job, const std::vector<compact::Steps>& steps) {
  std::optional<CompactTrial> best;
  for (const compact::Steps& tried : steps) {
    CURLIDAR_TRY_ASSIGN(trial, try_steps(job, tried, kQuickEffort));
    if (!best || trial.bits_per_point < best->bits_per_point) best = std::move(trial);
  }
  CURLIDAR_TRY_ASSIGN(final, try_steps(job, best->steps, job.settings.effort));
  final.encodings = static_cast<std::uint32_t>(steps.size()) + 1;
  return final;
}

std::int32_t units(double metres) {
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(std::llround(metres * compact::kRangeUnit), 1, 1 << 23));
}

/// Ranges within what directions leave of the bound.
Result<CompactTrial> encode_bounded(CompactJob& job) {
  const double bound = job.settings.target_value;
  const double beside = std::min(usual_distance_beside(job.cloud, job.scan, job.model), bound);
  const double left = std::sqrt(std::max(bound * bound - beside * beside, 0.01 * bound * bound));
  job.max_error = std::max(units(left) - 1, 1);
  const std::int32_t residual = 2 * job.max_error;
  std::vector<compact::Steps> steps;
  for (const double field_m : {0.5, 1.0, 2.0}) {
    compact::Steps s;
    s.residual_step = residual;
    s.step = static_cast<std::int32_t>(std::max(field_m * residual, 1.0));
    steps.push_back(s);
  }
  compact::Steps coarse;
  coarse.residual_step = residual;
  coarse.step = compact::kCoarseStep;
  if (coarse.step > 2 * residual) steps.push_back(coarse);
  return best_of(job, steps);
}

/// Ranges exactly on the sensor's unit, or so near that corrections are cheap.
Result<CompactTrial> encode_exactly(CompactJob& job, std::uint64_t range_unit_q48,
                                    CompactModel& model) {
  compact::Steps steps;
  steps.step = compact::kCoarseStep;
  job.max_error = 1;
  if (range_unit_q48 > 0) {
    steps.lattice_q32 = (range_unit_q48 + (1 << 15)) >> 16;
    model.table.rays->range_unit_q48 = range_unit_q48;
    steps.residual_step = static_cast<std::int32_t>(steps.lattice_q32 >> 16);
  } else {
    steps.residual_step = units(kExactStep_m);
    job.max_error = steps.residual_step / 2;
  }
  return try_steps(job, steps, job.settings.effort);
}

}  // namespace

Result<RecordImage> encode_record_image(const Cloud& cloud, const RecordLayout& layout,
                                        const std::vector<Vec3>& loose,
                                        const EncodeSettings& settings, double beside_bits,
                                        const ProgressCallback& progress,
                                        const PredictionSource* source) {
  const bool exact = settings.compact.target == CompactTarget::lossless;
  const double error_m = exact ? kExactStep_m / 8 : first_error_guess(settings.compact);
  RecordImage out;
  out.model = model_of(cloud, layout, error_m);
  add_offsets(cloud, layout.scan, error_m, step_of_offsets(settings.compact, error_m), out.model);
  CompactJob job{cloud, layout.scan, out.model, settings.compact, settings.threads, progress};
  job.loose = loose;
  job.beside_bits = beside_bits;
  std::optional<PredictedModel> predicted;
  if (source != nullptr) {
    // Rows are shared with those of a reference that has the same unit.
    if (exact && layout.lattice) {
      out.model.table.rays->range_unit_q48 = range_unit_of(*layout.lattice);
    }
    predicted = predict_model(*source, out.model);
  }
  if (predicted) job.predicted = &*predicted;
  if (!exact && !(predicted && predicted->header.same_rows)) {
    const RowModel rows = rows_of(layout, out.model, cloud, error_m);
    CURLIDAR_TRY(
        choose_range_offsets(job, estimate_range_offsets(layout.scan, rows), error_m, out.model));
  }
  Result<CompactTrial> trial = [&]() -> Result<CompactTrial> {
    if (exact) {
      return encode_exactly(job, layout.lattice ? range_unit_of(*layout.lattice) : 0, out.model);
    }
    if (settings.compact.target == CompactTarget::max_error) return encode_bounded(job);
    CURLIDAR_TRY(choose_kind(job));
    return search_target(job);
  }();
  if (!trial) return trial.error();
  out.trial = *std::move(trial);
  return out;
}

}  // namespace curlidar
