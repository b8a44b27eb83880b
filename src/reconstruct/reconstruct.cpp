// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-D: the field sampled on a grid of any density.
#include "curlidar/reconstruct.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "dense/density_profile.hpp"
#include "reconstruct/coded.hpp"
#include "reconstruct/finish.hpp"
#include "reconstruct/originals.hpp"

namespace curlidar {
namespace {

/// Nothing is invented on the coded lattice itself.
bool is_plain(const ReconstructSettings& settings) {
  return settings.rows == 1 && settings.columns == 1 && settings.masks;
}

/// Whether the grid's rows are those of the density profile's sensor.
bool has_rows_of_profile(const ReconstructSettings& settings) {
  return settings.density_profile &&
         settings.rows == static_cast<double>(settings.density_profile->given_every);
}

Result<Cloud> plain_cloud(const DecodedScan& scan, const ReconstructSettings& settings) {
  CURLIDAR_TRY(check_bounds(settings));
  if (settings.organised) CURLIDAR_TRY(check_lattice(scan));
  Cloud coded = coded_cloud(scan, settings.organised, settings.threads);
  CURLIDAR_TRY(check_points(1, coded.size(), "a cloud", settings));
  mark_coded(settings, coded);
  if (!settings.normals) return coded;
  // Between the returns only surfaces are asked for.
  ReconstructSettings surfaces = settings;
  surfaces.min_confidence = 0;
  surfaces.confidence = false;
  surfaces.density_profile = nullptr;
  CURLIDAR_TRY_ASSIGN(view, ScanView::make(scan, surfaces));
  add_normals(view, coded);
  return coded;
}

/// Half the elevation between a row of the grid and its neighbours.
double half_row(const Lattice& lattice, const DenseGrid& grid, std::size_t i) {
  const double half = 0.5 / grid.row_factor;
  return std::abs(lattice.elevation(grid.row(i) - half) - lattice.elevation(grid.row(i) + half)) /
         2;
}

/// Samples the grid; rows in which returns are taken lose their doubles.
Samples sample_grid(const ScanView& view, const DenseGrid& grid, const TakenDirections* taken,
                    const ProgressCallback& progress) {
  constexpr std::size_t kBatch = 64;
  const ReconstructSettings& settings = view.settings();
  std::vector<double> columns(grid.columns);
  for (std::size_t j = 0; j < columns.size(); ++j) columns[j] = grid.column(j);
  Samples all;
  in_batches(grid.rows, kBatch, progress, [&](std::size_t begin, std::size_t end) {
    std::vector<Samples> lines(end - begin);
    parallel_for(lines.size(), settings.threads, [&](std::size_t k) {
      const std::size_t i = begin + k;
      lines[k].resize(columns.size());
      view.look_along_row(grid.row(i), columns, lines[k].points, lines[k].confidence);
      const double half_height = half_row(view.field().lattice(), grid, i);
      for (Vec3& point : lines[k].points) {
        if (taken != nullptr && !std::isnan(point.x) && taken->near(point, half_height)) {
          point = kNowherePoint;
        }
      }
      if (!settings.organised) lines[k].drop_empty();
    });
    for (const Samples& line : lines) all.append(line);
  });
  all.width = static_cast<std::uint32_t>(settings.organised ? grid.columns : all.points.size());
  all.height = static_cast<std::uint32_t>(settings.organised ? grid.rows : 1);
  return all;
}

}  // namespace

Result<Cloud> reconstruct(const DecodedScan& scan, const ReconstructSettings& settings,
                          const ProgressCallback& progress) {
  CURLIDAR_TRY(check_kept(settings));
  if (is_plain(settings)) return plain_cloud(scan, settings);
  CURLIDAR_TRY_ASSIGN(view, ScanView::make(scan, settings, has_rows_of_profile(settings)));
  const DenseGrid grid(view.field().lattice(), settings.rows, settings.columns);
  if (!settings.keep_originals) {
    CURLIDAR_TRY(check_points(grid.rows, grid.columns, "a grid", settings));
    return finish(view, sample_grid(view, grid, nullptr, progress));
  }
  Cloud coded = coded_returns(scan, settings.threads);
  CURLIDAR_TRY(check_points(grid.rows, grid.columns, "a grid", settings, coded.size()));
  const TakenDirections taken(coded.positions,
                              std::numbers::pi / static_cast<double>(grid.columns));
  Samples invented = sample_grid(view, grid, &taken, progress);
  return finish_behind(view, std::move(coded), std::move(invented));
}

}  // namespace curlidar
