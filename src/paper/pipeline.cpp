// SPDX-License-Identifier: BSD-3-Clause
#include "paper/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "base/try.hpp"
#include "paper/outliers.hpp"

namespace curlidar {
namespace {

Status check_number(const char* what, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return Error{ErrorCode::invalid_argument,
               fmt::format("{} is {}, outside [{}, {}]", what, value, low, high)};
}

/// Samples of a patch's window, row-major.
std::vector<double> window_ranges(const SampleImage& samples, const CellRect& rect) {
  std::vector<double> ranges;
  ranges.reserve(rect.cells());
  const auto width = static_cast<std::int64_t>(samples.columns);
  for (std::int64_t row = rect.row_begin; row < rect.row_end; ++row) {
    const double* line = samples.range.data() + row * width;
    for (std::int64_t column = rect.column_begin; column < rect.column_end; ++column) {
      ranges.push_back(line[((column % width) + width) % width]);
    }
  }
  return ranges;
}

/// Absolute errors of the fit at the patch's own cells that hold a sample, infinite if the fit
/// represents nothing; 0 elsewhere.
void store_errors(const PatchGrid& grid, std::size_t patch_row, std::size_t patch_column,
                  const std::vector<double>& ranges, const std::vector<double>& fitted,
                  SampleImage& errors) {
  const CellRect own = grid.core(patch_row, patch_column);
  const CellRect all = grid.window(patch_row, patch_column);
  for (std::int64_t row = own.row_begin; row < own.row_end; ++row) {
    for (std::int64_t column = own.column_begin; column < own.column_end; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row - all.row_begin) * all.width() +
                               static_cast<std::size_t>(column - all.column_begin);
      if (ranges[cell] <= 0) continue;
      errors.range[errors.index(static_cast<std::size_t>(row), static_cast<std::size_t>(column))] =
          fitted.empty() ? std::numeric_limits<double>::infinity()
                         : std::abs(fitted[cell] - ranges[cell]);
    }
  }
}

/// Fits every patch to `samples`; errors are those of `judged` against the fits.
std::vector<PatchFit> fit_pass(const PatchGrid& grid, const SampleImage& samples,
                               const SampleImage& judged, const FitSettings& settings,
                               std::size_t threads, SampleImage& errors) {
  std::vector<PatchFit> patches(grid.count());
  errors = judged;
  std::fill(errors.range.begin(), errors.range.end(), 0.0);
  parallel_for(grid.rows(), threads, [&](std::size_t patch_row) {
    // All patches of a row share their basis, except a last one that is narrower.
    PatchBasis basis = grid.make_basis(patch_row, 0);
    for (std::size_t patch_column = 0; patch_column < grid.columns(); ++patch_column) {
      const CellRect window = grid.window(patch_row, patch_column);
      if (window.cells() != basis.cells()) basis = grid.make_basis(patch_row, patch_column);
      PatchFit& fit = patches[patch_row * grid.columns() + patch_column];
      fit = fit_patch(basis, window_ranges(samples, window), grid.roles(patch_row, patch_column),
                      settings);
      std::vector<double> fitted;
      if (!fit.coefficients.empty()) fitted = fitted_ranges(basis, fit);
      store_errors(grid, patch_row, patch_column, window_ranges(judged, window), fitted, errors);
    }
  });
  return patches;
}

}  // namespace

Status validate(const PaperSettings& s) {
  CURLIDAR_TRY(check_number("rows", s.rows, 0, 4096));
  CURLIDAR_TRY(check_number("columns", s.columns, 4, 65536));
  CURLIDAR_TRY(check_number("the minimum range", s.min_range_m, 0, 1e6));
  CURLIDAR_TRY(check_number("the maximum range", s.max_range.metres, 0, 1e7));
  CURLIDAR_TRY(check_number("the range percentile", s.max_range.percentile, 0, 100));
  CURLIDAR_TRY(check_number("the outlier radius", s.outlier_radius_m, 0, 1e6));
  CURLIDAR_TRY(check_number("the row factor of upsampling", s.upsample_rows, 1, 16));
  CURLIDAR_TRY(check_number("the column factor of upsampling", s.upsample_columns, 1, 16));
  CURLIDAR_TRY(check_number("the share of refused triangles", s.refused_triangle_share, 0, 1));
  CURLIDAR_TRY(check_number("the row cliff", s.cliffs.row_m, 0, 1e6));
  CURLIDAR_TRY(check_number("the column cliff", s.cliffs.column_m, 0, 1e6));
  CURLIDAR_TRY(check_number("the diagonal cliff", s.cliffs.diagonal_m, 0, 1e6));
  CURLIDAR_TRY(check_number("the patch size", s.patch, 1, 64));
  CURLIDAR_TRY(check_number("the overlap", s.overlap, 0, 64));
  const double height = s.patch * s.upsample_rows + 2.0 * s.overlap;
  const double width = s.patch * s.upsample_columns + 2.0 * s.overlap;
  CURLIDAR_TRY(
      check_number("the number of cells in a patch with its overlap", height * width, 1, 2048));
  CURLIDAR_TRY(check_number("the maximum degree", s.max_degree, 1, 1000));
  CURLIDAR_TRY(check_number("the accepted error", s.accept_m, 0, 1e6));
  CURLIDAR_TRY(check_number("the rejected error", s.reject_m, 0, 1e6));
  CURLIDAR_TRY(check_number("k", s.k, 1e-6, 1e6));
  CURLIDAR_TRY(check_number("the global degree", s.global_degree, 0, 128));
  return check_number("the rejected error of the global expansion", s.global_reject_m, 0, 1e6);
}

Status check_patches(const PaperSettings& settings, const Lattice& lattice) {
  constexpr std::uint64_t most = std::uint64_t{1} << 32;
  const PatchGrid grid(lattice, settings.upsample_rows, settings.upsample_columns, settings.patch,
                       settings.overlap);
  if (grid.basis_work() <= most) return {};
  return Error{ErrorCode::limit_exceeded,
               fmt::format("{} rows of patches of {} cells each take too long; take fewer rows, "
                           "less overlap or less upsampling",
                           grid.rows(), grid.window(grid.rows() / 2, 0).cells())};
}

PaperStages run_stages(const Cloud& cloud, const Detection& detection,
                       const PaperSettings& settings, const StageOptions& options,
                       const ProgressCallback& progress) {
  PaperStages out;
  Stopwatch watch;
  const auto done = [&](const char* stage, double fraction) {
    out.times.push_back({stage, watch.lap_ms()});
    if (progress) progress(stage, fraction);
  };
  const std::vector<bool> inliers =
      find_inliers(cloud, settings.outlier_radius_m, settings.outlier_min_points);
  done("outliers", 0.1);
  const ProjectSettings projection{settings.row_rule, settings.rows, settings.columns,
                                   settings.min_range_m, settings.max_range};
  out.image = fill_range_image(
      cloud, detection.ring_of_point, make_lattice(projection, detection.sensor), settings.row_rule,
      settings.min_range_m, resolve_max_range(settings.max_range, cloud, detection.sensor), inliers,
      out.counts);
  out.masks = make_masks(out.image, settings.cliffs);
  done("project", 0.2);
  if (options.always_mesh || settings.upsample_rows > 1 || settings.upsample_columns > 1) {
    out.mesh = make_polar_mesh(out.image);
  }
  done("mesh", 0.4);
  out.samples =
      upsample(out.image, out.mesh, out.masks, settings.upsample_rows, settings.upsample_columns,
               settings.refused_triangle_share, options.threads);
  done("upsample", 0.6);
  return out;
}

PaperModel fit_patches(const PaperStages& stages, const PaperSettings& settings,
                       std::size_t threads, const ProgressCallback& progress) {
  PaperModel model{stages.image.lattice, settings, stages.masks, {}};
  const auto& range = stages.image.range;
  model.settings.max_range = {range.empty() ? 0 : *std::max_element(range.begin(), range.end()), 0};
  const PatchGrid grid(model.lattice, settings.upsample_rows, settings.upsample_columns,
                       settings.patch, settings.overlap);
  const FitSettings fit{settings.max_degree, settings.accept_m, settings.k,
                        settings.stop_on_total_error};
  SampleImage errors;
  fit_pass(grid, stages.samples, stages.samples, fit, threads, errors);
  if (progress) progress("fit", 0.75);
  SampleImage kept = stages.samples;
  for (std::size_t cell = 0; cell < kept.range.size(); ++cell) {
    if (errors.range[cell] >= settings.reject_m) kept.range[cell] = 0;
  }
  model.patches = fit_pass(grid, kept, stages.samples, fit, threads, errors);
  for (std::size_t row = 0; row < errors.rows; ++row) {
    for (std::size_t column = 0; column < errors.columns; ++column) {
      if (errors.range[errors.index(row, column)] >= settings.reject_m) {
        refuse(model.masks, errors.position(row, column));
      }
    }
  }
  if (progress) progress("fit", 0.9);
  return model;
}

}  // namespace curlidar
