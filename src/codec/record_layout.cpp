// SPDX-License-Identifier: BSD-3-Clause
#include "codec/record_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/try.hpp"
#include "codec/beam_tables.hpp"
#include "codec/cell_points.hpp"
#include "image/range_image.hpp"

namespace curlidar {
namespace {

constexpr double kAngleUnits = 4294967296.0 / (2 * std::numbers::pi);

/// Below this share of the returns in cells, an image is not worth its mask.
constexpr double kLeastInCells = 0.7;

std::vector<std::uint32_t> returns_without_cell(const Cloud& cloud, const GriddedScan& scan) {
  std::vector<bool> placed(cloud.size(), false);
  for (const std::uint32_t source : scan.source) {
    if (source != kNoPoint) placed[source] = true;
  }
  std::vector<std::uint32_t> loose;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (is_return(cloud.positions[i]) && !placed[i]) loose.push_back(i);
  }
  return loose;
}

/// Bits of the masks of even columns and of the returns that share a cell, roughly: a mask costs
/// half of what independent cells would.
double cost_of_columns(const GriddedScan& scan, std::size_t returns) {
  constexpr double kBitsOfLoose = 30;
  const auto cells = static_cast<double>(scan.source.size());
  const double p = std::clamp(static_cast<double>(scan.counts.kept) / cells, 1e-9, 1 - 1e-9);
  const double entropy = -p * std::log2(p) - (1 - p) * std::log2(1 - p);
  return cells * entropy / 2 + kBitsOfLoose * static_cast<double>(returns - scan.counts.kept);
}

GriddedScan best_columns(const Cloud& cloud, const Detection& detection) {
  constexpr std::array<std::uint32_t, 9> kColumns{360,  512,  1024, 1440, 1800,
                                                  2048, 3072, 4096, 8192};
  std::vector<std::uint32_t> tried(kColumns.begin(), kColumns.end());
  if (cloud.organised() && cloud.width >= 4 && cloud.width <= 65536) tried.push_back(cloud.width);
  GriddedScan best;
  double least = 0;
  for (const std::uint32_t columns : tried) {
    GriddedScan scan = ring_scan(cloud, detection, columns, 0, kMaxCompactRangeM);
    const double cost = cost_of_columns(scan, detection.returns);
    if (best.rows != 0 && cost >= least) continue;
    least = cost;
    best = std::move(scan);
  }
  return best;
}

/// The cells of a lattice as a scan: row = beam, column = firing in space.
GriddedScan lattice_scan(const Cloud& cloud, const LatticeFit& fit, const compact::RayTable& rays) {
  GriddedScan scan;
  scan.rows = static_cast<std::uint32_t>(fit.beams.beams.size());
  scan.columns = static_cast<std::uint32_t>(fit.firings.size());
  scan.range.assign(std::size_t{scan.rows} * scan.columns, 0);
  scan.source.assign(scan.range.size(), kNoPoint);
  scan.max_range_m = kMaxCompactRangeM;
  for (const Beam& beam : fit.beams.beams) scan.elevations.push_back(beam.elevation);
  scan.counts.returns = fit.returns;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (fit.firing_of_point[i] == kNoFiring) continue;
    const std::size_t ring = fit.ring_of_point[i];
    const double range = fit.range_of_point[i] + fit.beams.beams[ring].range_phase_m;
    if (!(range > 1e-3) || range > kMaxCompactRangeM) continue;
    const auto columns = static_cast<std::int64_t>(scan.columns);
    const std::int64_t column =
        (std::int64_t{fit.firing_of_point[i]} + rays.column_shift(ring) + columns) % columns;
    const std::size_t cell =
        scan.cell(static_cast<std::uint32_t>(ring), static_cast<std::uint32_t>(column));
    scan.range[cell] = range;
    scan.source[cell] = i;
    ++scan.counts.kept;
  }
  return scan;
}

/// The rings of the cloud; nothing if it has none.
Result<std::optional<Detection>> find_rings(const Cloud& cloud, const EncodeSettings& settings) {
  if (settings.sensor) {
    CURLIDAR_TRY_ASSIGN(given, assign_rings(cloud, *settings.sensor));
    return std::optional<Detection>(std::move(given));
  }
  Result<Detection> found = detect_sensor(cloud);
  if (!found || found->source == RingSource::uniform ||
      found->sensor.pattern == ScanPattern::limited_field) {
    return std::optional<Detection>();
  }
  return std::optional<Detection>(*std::move(found));
}

/// Distance of a return from the middle of its cell, across and up, as binary angles.
DirectionOffset offset_from_middle(const compact::RowTable& table, std::uint32_t row,
                                   std::uint32_t column, std::int32_t range, const Vec3& p) {
  const auto angle = [](double radians) {
    return static_cast<std::uint32_t>(
        static_cast<std::int64_t>(std::llround(radians * kAngleUnits)));
  };
  const std::uint32_t azimuth =
      compact::azimuth_of_column(std::uint64_t{table.first_column} + column, table.turn_columns);
  return {
      static_cast<std::int32_t>(angle(azimuth_of(p)) - azimuth),
      static_cast<std::int32_t>(angle(elevation_of(p)) - compact::elevation_at(table, row, range))};
}

}  // namespace

RecordLayout lay_out_loose(const Cloud& cloud) {
  RecordLayout layout;
  layout.loose = returns_without_cell(cloud, layout.scan);
  layout.scan.counts.returns = layout.loose.size();
  return layout;
}

Result<RecordLayout> lay_out(const Cloud& cloud, const EncodeSettings& settings) {
  RecordLayout layout;
  if (count_returns(cloud) == 0) return layout;
  if (!settings.sensor) {
    if (auto centres = cell_centre_scan(cloud, 0, kMaxCompactRangeM)) {
      layout.scan = *std::move(centres);
      layout.loose = returns_without_cell(cloud, layout.scan);
      return layout;
    }
  }
  CURLIDAR_TRY_ASSIGN(rings, find_rings(cloud, settings));
  if (!rings) {
    layout = lay_out_loose(cloud);
    layout.notes.push_back(
        "No rings of a spinning sensor were found: the points are coded one after the other, "
        "without a field.");
    return layout;
  }
  CURLIDAR_TRY_ASSIGN(lattice, find_sensor_lattice(cloud, *rings, settings));
  if (lattice) {
    layout.notes = lattice->notes;
    layout.scan = lattice_scan(cloud, *lattice, *ray_rows(*lattice, 0).rays);
    layout.scan.sensor = rings->sensor.name;
    layout.lattice = std::move(lattice);
  } else {
    layout.scan = best_columns(cloud, *rings);
    layout.notes.push_back(
        "The scan fits no known lattice of rays: directions are coded beside ranges; "
        "'curlidar calibrate' may find the sensor's own.");
  }
  layout.loose = returns_without_cell(cloud, layout.scan);
  const auto kept = static_cast<double>(layout.scan.counts.kept);
  if (kept < kLeastInCells * static_cast<double>(count_returns(cloud))) {
    return lay_out_loose(cloud);
  }
  return layout;
}

CompactModel model_of(const Cloud& cloud, const RecordLayout& layout, double error_m) {
  const GriddedScan& scan = layout.scan;
  if (!layout.lattice) return make_model(scan, fit_rows(cloud, scan, error_m), error_m);
  CompactModel model;
  model.table = ray_rows(*layout.lattice, error_m);
  const compact::RowTable& table = model.table;
  model.image.rows = scan.rows;
  model.image.columns = scan.columns;
  model.image.range.assign(scan.range.size(), 0);
  for (std::size_t cell = 0; cell < scan.range.size(); ++cell) {
    if (scan.source[cell] == kNoPoint) continue;
    const std::int64_t phase = table.rays->rays[cell / scan.columns].range_phase;
    const std::int64_t range = std::llround(scan.range[cell] * compact::kRangeUnit) - phase;
    model.image.range[cell] = static_cast<std::int32_t>(std::max<std::int64_t>(range, 1));
  }
  return model;
}

void add_offsets(const Cloud& cloud, const GriddedScan& scan, double error_m, double step_m,
                 CompactModel& model) {
  // Beside that of the ranges, a tenth of the wanted error does not show.
  constexpr double kShows = 0.1;
  if (model.table.rays) return;
  std::vector<DirectionOffset> offsets;
  double beside_m = 0;
  for (std::uint32_t row = 0; row < scan.rows; ++row) {
    for (std::uint32_t column = 0; column < scan.columns; ++column) {
      const std::size_t cell = scan.cell(row, column);
      if (scan.source[cell] == kNoPoint) continue;
      const Vec3& p = cloud.positions[scan.source[cell]];
      offsets.push_back(offset_from_middle(model.table, row, column, model.image.range[cell], p));
      beside_m += scan.range[cell] / kAngleUnits *
                  std::hypot(offsets.back().across, static_cast<double>(offsets.back().up));
    }
  }
  if (offsets.empty() || beside_m < kShows * error_m * static_cast<double>(offsets.size())) return;
  model.offsets = std::move(offsets);
  model.direction_step = static_cast<std::int32_t>(
      std::clamp<std::int64_t>(std::llround(step_m * compact::kRangeUnit), 1, 1 << 24));
}

}  // namespace curlidar
