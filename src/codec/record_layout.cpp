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

/// A return on its way to a column of its ring.
struct Sighted {
  double column = 0;  ///< where it looks, in columns
  std::uint32_t slot = 0;
};

/// The returns of every ring by azimuth, in parts of a turn.
std::vector<std::vector<Sighted>> sort_by_azimuth(const Cloud& cloud, const Detection& detection) {
  std::vector<std::vector<Sighted>> rings(detection.ring_elevations.size());
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const std::uint16_t ring = detection.ring_of_point[i];
    const Vec3& p = cloud.positions[i];
    if (ring == kNoRing || norm(p) > kMaxCompactRangeM) continue;
    rings[ring].push_back({azimuth_of(p) / (2 * std::numbers::pi) + 0.5, i});
  }
  for (std::vector<Sighted>& ring : rings) {
    std::sort(ring.begin(), ring.end(), [](const Sighted& a, const Sighted& b) {
      return a.column != b.column ? a.column < b.column : a.slot < b.slot;
    });
  }
  return rings;
}

/// Columns of their own for the returns of a ring, ascending, as near to where they look as that
/// allows: isotonic regression of what is left of a return's column without its number, by pooling
/// neighbours that are out of order. There must be no more returns than columns.
std::vector<std::uint32_t> own_columns(const std::vector<Sighted>& ring, std::uint32_t columns) {
  struct Pool {
    double sum = 0;
    std::size_t count = 0;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    pools.push_back({ring[i].column * columns - static_cast<double>(i), 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back().sum += last.sum;
      pools.back().count += last.count;
    }
  }
  std::vector<std::uint32_t> out;
  const double most = static_cast<double>(columns - ring.size());
  for (const Pool& pool : pools) {
    const auto shift = static_cast<std::size_t>(std::clamp(std::round(pool.mean()), 0.0, most));
    for (std::size_t k = 0; k < pool.count; ++k) {
      out.push_back(static_cast<std::uint32_t>(shift + out.size()));
    }
  }
  return out;
}

/// Bits of the mask and of the offsets that come from sharing out columns, roughly: a mask costs
/// half of what independent cells would, an offset what doubling it adds.
double cost_of_columns(const std::vector<std::vector<Sighted>>& rings, std::uint32_t columns) {
  double returns = 0, offsets = 0;
  for (const std::vector<Sighted>& ring : rings) {
    const std::vector<std::uint32_t> own = own_columns(ring, columns);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      offsets += std::log2(1 + std::abs(ring[i].column * columns - own[i]));
    }
    returns += static_cast<double>(ring.size());
  }
  const double cells = static_cast<double>(rings.size()) * columns;
  const double p = std::clamp(returns / cells, 1e-9, 1 - 1e-9);
  const double entropy = -p * std::log2(p) - (1 - p) * std::log2(1 - p);
  return cells * entropy / 2 + offsets;
}

/// Numbers of columns worth trying for rings of at most `most` returns.
std::vector<std::uint32_t> column_counts(const Cloud& cloud, std::size_t most) {
  std::vector<std::uint32_t> counts;
  const auto add = [&](double columns) {
    if (columns >= std::max<double>(4, static_cast<double>(most)) && columns <= 65536) {
      counts.push_back(static_cast<std::uint32_t>(columns));
    }
  };
  for (const double share : {1.0, 1.01, 1.03, 1.1, 1.25, 1.5, 2.0}) {
    add(std::ceil(share * static_cast<double>(most)));
  }
  for (const double usual : {360, 512, 900, 1024, 1800, 2000, 2048, 3600, 4096}) add(usual);
  if (cloud.organised()) add(cloud.width);
  return counts;
}

/// Rings on even columns, every return of a ring in a column of its own.
GriddedScan ring_columns(const Cloud& cloud, const Detection& detection) {
  const std::vector<std::vector<Sighted>> rings = sort_by_azimuth(cloud, detection);
  std::size_t most = 4;
  for (const std::vector<Sighted>& ring : rings) most = std::max(most, ring.size());
  std::uint32_t columns = 0;
  double least = 0;
  for (const std::uint32_t tried : column_counts(cloud, most)) {
    const double cost = cost_of_columns(rings, tried);
    if (columns != 0 && cost >= least) continue;
    columns = tried;
    least = cost;
  }
  GriddedScan scan;
  if (columns == 0) return scan;
  scan.rows = static_cast<std::uint32_t>(rings.size());
  scan.columns = columns;
  scan.range.assign(std::size_t{scan.rows} * columns, 0);
  scan.source.assign(scan.range.size(), kNoPoint);
  scan.elevations = detection.ring_elevations;
  scan.max_range_m = kMaxCompactRangeM;
  scan.sensor = detection.sensor.name;
  scan.counts.returns = detection.returns;
  for (std::uint32_t row = 0; row < scan.rows; ++row) {
    const std::vector<std::uint32_t> own = own_columns(rings[row], columns);
    for (std::size_t i = 0; i < own.size(); ++i) {
      const std::size_t cell = scan.cell(row, own[i]);
      scan.source[cell] = rings[row][i].slot;
      scan.range[cell] = norm(cloud.positions[rings[row][i].slot]);
    }
    scan.counts.kept += own.size();
  }
  return scan;
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
    layout.scan = ring_columns(cloud, *rings);
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
