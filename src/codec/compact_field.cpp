// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace curlidar {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeastWeight = 0.5 - 1e-9;
constexpr double kAgreeMetres = 0.3, kAgreeShare = 0.1;

Lattice lattice_of(const compact::DecodedScan& scan) {
  std::vector<double> elevations;
  for (const std::int32_t e : scan.table.elevation) elevations.push_back(radians_from_angle(e));
  return Lattice::from_rings(std::move(elevations), scan.parameters.columns);
}

compact::Direction to_direction(double x, double y, double z) {
  const auto unit = [](double v) { return static_cast<std::int32_t>(std::llround(v * (1 << 22))); };
  return {unit(x), unit(y), unit(z)};
}

/// For each row the nearest that is known, of two the one above; their count where none is.
std::vector<std::uint32_t> nearest_known(const std::vector<bool>& known) {
  const auto rows = static_cast<std::uint32_t>(known.size());
  std::vector<std::uint32_t> nearest(rows, rows);
  std::uint32_t last = rows;
  for (std::uint32_t row = 0; row < rows; ++row) {
    if (known[row]) last = row;
    nearest[row] = last;
  }
  last = rows;
  for (std::uint32_t row = rows; row-- > 0;) {
    if (known[row]) last = row;
    if (last == rows) continue;
    if (nearest[row] == rows || last - row < row - nearest[row]) nearest[row] = last;
  }
  return nearest;
}

/// For every cell a coded one near it: the nearest in its row, else in rows further and further
/// away. Enough for views of a scan without masks.
std::vector<std::uint32_t> nearest_coded(const std::vector<std::int32_t>& range, std::uint32_t rows,
                                         std::uint32_t columns) {
  constexpr std::uint32_t kNone = UINT32_MAX;
  std::vector<std::uint32_t> nearest(range.size(), kNone);
  std::vector<bool> known(rows, false);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const std::size_t begin = std::size_t{row} * columns;
    std::vector<std::uint32_t> far(columns, UINT32_MAX);
    for (const bool forward : {true, false}) {
      std::uint32_t last = kNone, away = 0;
      for (std::uint32_t step = 0; step < 2 * columns; ++step) {
        const std::uint32_t column = forward ? step % columns : columns - 1 - step % columns;
        if (range[begin + column] > 0) {
          last = static_cast<std::uint32_t>(begin + column);
          away = 0;
        }
        if (last != kNone && away < far[column]) {
          far[column] = away;
          nearest[begin + column] = last;
        }
        ++away;
      }
      known[row] = last != kNone;
    }
  }
  const std::vector<std::uint32_t> rows_near = nearest_known(known);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const std::uint32_t from = rows_near[row];
    if (from == row || from == rows) continue;
    std::copy_n(nearest.begin() + static_cast<std::ptrdiff_t>(std::size_t{from} * columns), columns,
                nearest.begin() + static_cast<std::ptrdiff_t>(std::size_t{row} * columns));
  }
  return nearest;
}

}  // namespace

CompactField::CompactField(compact::DecodedScan scan)
    : scan_(std::move(scan)),
      lattice_(lattice_of(scan_)),
      correction_(scan_.range.size(), 0),
      nearest_(nearest_coded(scan_.range, scan_.parameters.rows, scan_.parameters.columns)) {
  for (const std::int32_t height : scan_.table.height) {
    height_m_.push_back(static_cast<double>(height) / compact::kRangeUnit);
  }
  for (const compact::SegmentPlace& place : segments_of(scan_.parameters)) {
    const compact::Geometry geometry = geometry_of(scan_.table, place);
    for (std::uint32_t row = 0; row < place.rows; ++row) {
      for (std::uint32_t column = 0; column < place.columns; ++column) {
        const std::size_t at = cell(place.row + row, place.column + column);
        if (scan_.range[at] <= 0 || scan_.surface[at] < 0) continue;
        const auto& placed = scan_.surfaces[static_cast<std::size_t>(scan_.surface[at])];
        const compact::Direction& d =
            geometry.directions()[std::size_t{row} * geometry.columns() + column];
        correction_[at] = static_cast<std::int32_t>(scan_.range[at] - offset(place.row + row) -
                                                    placed.surface.range_at(placed.frame, d));
      }
    }
  }
}

double CompactField::elevation(double row, double range) const {
  const double base = lattice_.elevation(row);
  if (height_m_.empty() || !(range > 0)) return base;
  const double last = static_cast<double>(height_m_.size() - 1);
  const double inside = std::clamp(row, 0.0, last);
  const auto k = static_cast<std::size_t>(std::min(std::floor(inside), std::max(last - 1, 0.0)));
  const double share = inside - static_cast<double>(k);
  const double next = height_m_[std::min(k + 1, height_m_.size() - 1)];
  return base + (height_m_[k] + (next - height_m_[k]) * share) / range;
}

double CompactField::calibrated(std::size_t cell) const {
  const auto row = static_cast<std::uint32_t>(cell / lattice_.columns());
  return static_cast<double>(scan_.range[cell] - offset(row)) / compact::kRangeUnit;
}

double CompactField::extend(std::size_t cell, const compact::Direction& direction) const {
  if (scan_.surface[cell] < 0) return calibrated(cell);
  const auto& placed = scan_.surfaces[static_cast<std::size_t>(scan_.surface[cell])];
  const std::int64_t range = placed.surface.range_at(placed.frame, direction) + correction_[cell];
  return static_cast<double>(std::max<std::int64_t>(range, 1)) / compact::kRangeUnit;
}

double CompactField::range_at(const std::array<Corner, 4>& corners,
                              const compact::Direction& direction, bool masked) const {
  double weight = 0, sum = 0;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  double best_weight = 0, best = kNan;
  for (const Corner& corner : corners) {
    if (corner.weight <= 0 || scan_.range[corner.cell] <= 0) continue;
    // On a cell itself nothing is rounded on the way.
    const double range =
        corner.weight == 1 ? calibrated(corner.cell) : extend(corner.cell, direction);
    weight += corner.weight;
    sum += corner.weight * range;
    low = std::min(low, range);
    high = std::max(high, range);
    if (corner.weight > best_weight) {
      best_weight = corner.weight;
      best = range;
    }
  }
  const bool agree = high - low <= kAgreeMetres + kAgreeShare * low;
  if (masked) return weight >= kLeastWeight && agree ? sum / weight : kNan;
  if (weight > 0) return agree ? sum / weight : best;
  const auto most =
      std::max_element(corners.begin(), corners.end(),
                       [](const Corner& a, const Corner& b) { return a.weight < b.weight; });
  const std::uint32_t nearest = nearest_[most->cell];
  return nearest == UINT32_MAX ? kNan : calibrated(nearest);
}

void CompactField::evaluate_row(double row, std::span<const double> columns, bool masked,
                                std::span<double> ranges) const {
  const double last_row = static_cast<double>(lattice_.rows() - 1);
  const double inside = std::clamp(row, 0.0, last_row);
  const auto top = static_cast<std::uint32_t>(inside);
  const std::uint32_t bottom = std::min(top + 1, lattice_.rows() - 1);
  const double down = inside - top;
  const double ring_offset =
      down == 0 ? static_cast<double>(offset(top)) / compact::kRangeUnit : 0.0;
  const double elevation = lattice_.elevation(row);
  const double flat = std::cos(elevation), up = std::sin(elevation);
  const std::uint32_t width = lattice_.columns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    double column = columns[i] - std::floor(columns[i] / width) * width;
    if (!(column < width)) column = 0;
    const auto left = static_cast<std::uint32_t>(column);
    const std::uint32_t right = left + 1 < width ? left + 1 : 0;
    const double across = column - left;
    const double azimuth = lattice_.azimuth(column);
    const compact::Direction direction =
        to_direction(flat * std::cos(azimuth), flat * std::sin(azimuth), up);
    ranges[i] = range_at({{{cell(top, left), (1 - down) * (1 - across)},
                           {cell(top, right), (1 - down) * across},
                           {cell(bottom, left), down * (1 - across)},
                           {cell(bottom, right), down * across}}},
                         direction, masked) +
                ring_offset;
  }
}

void EmptyField::evaluate_row(double, std::span<const double>, bool,
                              std::span<double> ranges) const {
  std::fill(ranges.begin(), ranges.end(), kNan);
}

}  // namespace curlidar
