// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "codec/cell_points.hpp"
#include "image/range_image.hpp"

namespace curlidar {
namespace {

constexpr double kAngleUnits = 4294967296.0 / (2 * std::numbers::pi);

/// Numbers of rows are coded this much finer than the wanted error. Together they then add less to
/// the error than a quarter of a percent, and each further bit would cost as much again.
constexpr double kFinerThanError = 8;

double mean_range(const GriddedScan& scan) {
  double sum = 0;
  for (const double range : scan.range) sum += range;
  return sum / static_cast<double>(std::max<std::size_t>(scan.counts.kept, 1));
}

bool descending(const std::vector<std::int32_t>& values) {
  return std::adjacent_find(values.begin(), values.end(), [](auto a, auto b) { return a <= b; }) ==
         values.end();
}

/// Elevations rounded as coarsely as allowed, but so that rows stay apart.
void set_elevations(compact::RowTable& table, const std::vector<double>& elevations,
                    std::uint32_t shift) {
  for (;; --shift) {
    table.elevation.clear();
    for (const double e : elevations) {
      table.elevation.push_back(static_cast<std::int32_t>(std::llround(e * kAngleUnits)));
    }
    table.elevation_shift = shift;
    compact::round_to_shifts(table);
    if (shift == 0 || descending(table.elevation)) return;
  }
}

/// The power of two, as a shift, that is at most `unit` units; 0 if there is none.
std::uint32_t shift_below(double unit) {
  const double shift = unit >= 1 ? std::floor(std::log2(unit)) : 0;
  return static_cast<std::uint32_t>(std::min<double>(shift, compact::kMaxTableShift));
}

}  // namespace

CompactModel make_model(const GriddedScan& scan, const RowModel& rows, double error_m) {
  CompactModel model;
  model.image.rows = scan.rows;
  model.image.columns = scan.columns;
  model.image.range.reserve(scan.range.size());
  for (std::size_t cell = 0; cell < scan.range.size(); ++cell) {
    const auto range =
        static_cast<std::int32_t>(std::llround(scan.range[cell] * compact::kRangeUnit));
    model.image.range.push_back(scan.source[cell] == kNoPoint ? 0 : std::max(range, 1));
  }
  compact::RowTable& table = model.table;
  table.turn_columns = scan.columns;
  const double unit_m = error_m / kFinerThanError;
  table.height_shift = shift_below(unit_m * compact::kRangeUnit);
  for (const double height : rows.height) {
    table.height.push_back(static_cast<std::int32_t>(std::llround(height * compact::kRangeUnit)));
  }
  set_elevations(table, rows.elevation, shift_below(unit_m / mean_range(scan) * kAngleUnits));
  return model;
}

void set_range_offsets(compact::RowTable& table, const std::vector<double>& offsets,
                       double error_m) {
  table.offset_shift = shift_below(error_m / kFinerThanError * compact::kRangeUnit);
  table.range_offset.clear();
  for (const double offset : offsets) {
    const double most = compact::kMaxRowOffset / 2;
    table.range_offset.push_back(static_cast<std::int32_t>(
        std::llround(std::clamp(offset * compact::kRangeUnit, -most, most))));
  }
  compact::round_to_shifts(table);
  const bool none = std::all_of(table.range_offset.begin(), table.range_offset.end(),
                                [](std::int32_t offset) { return offset == 0; });
  if (none) table.range_offset.clear();
}

OwnErrors own_errors(const Cloud& cloud, const GriddedScan& scan, const std::vector<Vec3>& points) {
  OwnErrors errors;
  double sum = 0, squares = 0;
  std::size_t i = 0;
  for (const std::uint32_t source : scan.source) {
    if (source == kNoPoint) continue;
    const double distance = norm(points[i++] - cloud.positions[source]);
    sum += distance;
    squares += distance * distance;
    errors.max = std::max(errors.max, distance);
  }
  const auto n = static_cast<double>(std::max<std::size_t>(scan.counts.kept, 1));
  errors.mean = sum / n;
  errors.rms = std::sqrt(squares / n);
  return errors;
}

CellOffsets cell_offsets(const Cloud& cloud, const GriddedScan& scan,
                         const compact::RowTable& table) {
  const Lattice circle = Lattice::from_rings({0}, scan.columns);
  CellOffsets sum;
  for (std::uint32_t row = 0; row < scan.rows; ++row) {
    for (std::uint32_t column = 0; column < scan.columns; ++column) {
      const std::size_t cell = scan.cell(row, column);
      if (scan.source[cell] == kNoPoint) continue;
      const Vec3& p = cloud.positions[scan.source[cell]];
      const double range = norm(p);
      const double turned =
          std::remainder(azimuth_of(p) - circle.azimuth(column), 2 * std::numbers::pi);
      sum.across += std::abs(turned) * std::hypot(p.x, p.y);
      const double height = table.height.empty() ? 0 : table.height[row];
      const double looks =
          table.elevation[row] / kAngleUnits + height / compact::kRangeUnit / range;
      sum.along += std::abs(elevation_of(p) - looks) * range;
    }
  }
  const auto n = static_cast<double>(std::max<std::size_t>(scan.counts.kept, 1));
  return {sum.across / n, sum.along / n};
}

std::vector<Vec3> points_of(const CompactModel& model, const compact::Image& decoded) {
  std::vector<DirectionOffset> offsets;
  if (model.direction_step > 0) {
    std::size_t i = 0;
    for (const std::int32_t range : decoded.range) {
      if (range <= 0) continue;
      const std::int64_t step = direction_step(range, model.direction_step);
      const auto rounded = [&](std::int32_t offset) {
        return static_cast<std::int32_t>(div_round(offset, step) * step);
      };
      const DirectionOffset& exact = model.offsets[i++];
      offsets.push_back({rounded(exact.across), rounded(exact.up)});
    }
  }
  return cell_points(model.table, decoded, offsets);
}

}  // namespace curlidar
