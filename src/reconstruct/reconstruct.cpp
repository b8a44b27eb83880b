// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-D: the field sampled on a grid of any density.
#include "curlidar/reconstruct.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "reconstruct/attributes.hpp"
#include "reconstruct/finish.hpp"
#include "reconstruct/originals.hpp"

namespace curlidar {
namespace {

bool is_plain(const ReconstructSettings& settings) {
  return settings.rows == 1 && settings.columns == 1 && settings.masks && !settings.keep_originals;
}

bool wants_extras(const ReconstructSettings& settings) {
  return settings.confidence || settings.normals || settings.original;
}

/// Half the elevation between a row of the grid and its neighbours.
double half_row(const Lattice& lattice, const DenseGrid& grid, std::size_t i) {
  const double half = 0.5 / grid.row_factor;
  return std::abs(lattice.elevation(grid.row(i) - half) - lattice.elevation(grid.row(i) + half)) /
         2;
}

/// Samples the grid; rows in which returns are taken lose their doubles.
Samples sample_grid(const View& view, const DenseGrid& grid, const TakenDirections* taken,
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
          point = kNoPoint;
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
  const bool whole = scan.cloud && !settings.organised;
  if (is_plain(settings) && whole && !wants_extras(settings)) return *scan.cloud;
  CURLIDAR_TRY(check_kept(settings));
  CURLIDAR_TRY_ASSIGN(view, View::make(scan, settings));
  if (is_plain(settings) && (whole || !scan.points.empty())) {
    Cloud coded = coded_cloud(scan, settings.organised);
    add_extras(view, coded);
    return coded;
  }
  const DenseGrid grid(view.field().lattice(), settings.rows, settings.columns);
  CURLIDAR_TRY(check_points(grid.rows, grid.columns, "a grid", settings));
  if (!settings.keep_originals) return finish(view, sample_grid(view, grid, nullptr, progress));
  CURLIDAR_TRY_ASSIGN(originals, kept_originals(scan, settings.threads));
  const TakenDirections taken(originals.positions,
                              std::numbers::pi / static_cast<double>(grid.columns));
  Cloud invented = finish(view, sample_grid(view, grid, &taken, progress));
  add_extras(view, originals);
  return behind(std::move(originals), invented);
}

}  // namespace curlidar
