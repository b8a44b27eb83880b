// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "codec/beam_tables.hpp"
#include "compact/ray_points.hpp"
#include "compact/scan_points.hpp"

namespace curlidar {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeastWeight = 0.5 - 1e-9;
constexpr std::uint32_t kNoCell = UINT32_MAX;
/// No coordinate of moved points is farther out.
constexpr double kFarthest_m = 65536;
constexpr double kAgreeMetres = 0.3, kAgreeShare = 0.1;

Lattice lattice_of(const compact::DecodedScan& scan) {
  std::vector<double> elevations;
  for (const std::int32_t e : scan.table.elevation) elevations.push_back(radians_from_angle(e));
  return Lattice::from_rings(std::move(elevations), scan.parameters.columns);
}

double metres(std::int32_t units) {
  return static_cast<double>(units) / compact::kRangeUnit;
}

compact::FixedPoint to_fixed(const Vec3& p) {
  const auto units = [](double v) {
    return std::llround(std::clamp(v, -kFarthest_m, kFarthest_m) * 0x1p36);
  };
  return {units(p.x), units(p.y), units(p.z)};
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
  std::vector<std::uint32_t> nearest(range.size(), kNoCell);
  std::vector<bool> known(rows, false);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const std::size_t begin = std::size_t{row} * columns;
    std::vector<std::uint32_t> far(columns, UINT32_MAX);
    for (const bool forward : {true, false}) {
      std::uint32_t last = kNoCell, away = 0;
      for (std::uint32_t step = 0; step < 2 * columns; ++step) {
        const std::uint32_t column = forward ? step % columns : columns - 1 - step % columns;
        if (range[begin + column] > 0) {
          last = static_cast<std::uint32_t>(begin + column);
          away = 0;
        }
        if (last != kNoCell && away < far[column]) {
          far[column] = away;
          nearest[begin + column] = last;
        }
        ++away;
      }
      known[row] = last != kNoCell;
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
  for (const std::int32_t height : scan_.table.height) height_m_.push_back(metres(height));
  if (scan_.table.rays) find_rays();
  find_corrections();
}

void CompactField::find_rays() {
  for (const compact::Ray& ray : scan_.table.rays->rays) height_m_.push_back(metres(ray.height));
  for (const double elevation : lattice_.elevations()) level_.push_back(std::cos(elevation));
  std::vector<std::int32_t> range = scan_.range;
  for (std::size_t at = 0; at < range.size(); ++at) {
    if (range[at] <= 0 && nearest_[at] != kNoCell) range[at] = scan_.range[nearest_[at]];
  }
  rays_.emplace(scan_.table, range);
}

void CompactField::find_corrections() {
  for (const compact::SegmentPlace& place : segments_of(scan_.parameters)) {
    const compact::Geometry geometry = geometry_of(scan_.table, place);
    for (std::uint32_t row = 0; row < place.rows; ++row) {
      for (std::uint32_t column = 0; column < place.columns; ++column) {
        const std::size_t at = cell(place.row + row, place.column + column);
        if (scan_.range[at] <= 0 || scan_.surface[at] < 0) continue;
        const auto& frame = scan_.surfaces[static_cast<std::size_t>(scan_.surface[at])].frame;
        const compact::Sight sight = geometry.sight(std::size_t{row} * geometry.columns() + column);
        correction_[at] = static_cast<std::int32_t>(scan_.range[at] - offset(place.row + row) -
                                                    surface_in(scan_, at).range_at(frame, sight));
      }
    }
  }
}

CompactField::Between CompactField::between(double row) const {
  const std::uint32_t last = lattice_.rows() - 1;
  const double inside = std::fmin(std::fmax(row, 0.0), static_cast<double>(last));
  const auto top = static_cast<std::uint32_t>(inside);
  return {top, std::min(top + 1, last), inside - top};
}

CompactField::Corners CompactField::corners_of(const Between& rows, double column) const {
  ColumnPair top, bottom;
  if (rays_) {
    const std::uint32_t azimuth = angle_from_radians(lattice_.azimuth(column));
    top = rays_->around(rows.top, azimuth);
    bottom = rays_->around(rows.bottom, azimuth);
  } else {
    top.left = static_cast<std::uint32_t>(column);
    top.right = top.left + 1 < lattice_.columns() ? top.left + 1 : 0;
    top.right_weight = column - top.left;
    top.left_weight = 1 - top.right_weight;
    bottom = top;
  }
  return {{{cell(rows.top, top.left), (1 - rows.down) * top.left_weight},
           {cell(rows.top, top.right), (1 - rows.down) * top.right_weight},
           {cell(rows.bottom, bottom.left), rows.down * bottom.left_weight},
           {cell(rows.bottom, bottom.right), rows.down * bottom.right_weight}}};
}

double CompactField::height_at(const Between& rows) const {
  if (height_m_.empty()) return 0;
  const double top = height_m_[rows.top];
  return top + (height_m_[rows.bottom] - top) * rows.down;
}

compact::Origin CompactField::origin_of(const Between& rows) const {
  if (!scan_.table.rays) return {};
  const double height = height_at(rows) * compact::kRangeUnit;
  return {
      0, 0,
      static_cast<std::int32_t>(std::llround(height)) - compact::centre_height(*scan_.table.rays)};
}

std::int32_t CompactField::offset(std::uint32_t row) const {
  const compact::RowTable& table = scan_.table;
  const std::int32_t offset = table.range_offset.empty() ? 0 : table.range_offset[row];
  return table.rays ? offset - table.rays->rays[row].range_phase : offset;
}

double CompactField::calibrated(std::size_t cell) const {
  const auto row = static_cast<std::uint32_t>(cell / lattice_.columns());
  const double range = metres(scan_.range[cell] - offset(row));
  if (!scan_.table.rays) return range;
  const double lateral = metres(scan_.table.rays->rays[row].lateral);
  return lateral == 0 ? range : std::hypot(range * level_[row], lateral) / level_[row];
}

double CompactField::extend(std::size_t cell, const compact::Sight& sight) const {
  if (scan_.surface[cell] < 0) return calibrated(cell);
  const auto& frame = scan_.surfaces[static_cast<std::size_t>(scan_.surface[cell])].frame;
  const std::int64_t range = surface_in(scan_, cell).range_at(frame, sight) + correction_[cell];
  return static_cast<double>(std::max<std::int64_t>(range, 1)) / compact::kRangeUnit;
}

std::uint32_t CompactField::replacement(const Corners& corners) const {
  const auto most =
      std::max_element(corners.begin(), corners.end(),
                       [](const Corner& a, const Corner& b) { return a.weight < b.weight; });
  return nearest_[most->cell];
}

double CompactField::range_at(const Corners& corners, const compact::Sight& sight,
                              bool masked) const {
  double weight = 0, sum = 0;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  double best_weight = 0, best = kNan;
  for (const Corner& corner : corners) {
    if (corner.weight <= 0 || scan_.range[corner.cell] <= 0) continue;
    // On a cell itself nothing is rounded on the way.
    const double range = corner.weight == 1 ? calibrated(corner.cell) : extend(corner.cell, sight);
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
  const std::uint32_t nearest = replacement(corners);
  return nearest == kNoCell ? kNan : calibrated(nearest);
}

void CompactField::evaluate_row(double row, std::span<const double> columns, bool masked,
                                std::span<double> ranges) const {
  const Between rows = between(row);
  const double elevation = lattice_.elevation(row);
  const double flat = std::cos(elevation), up = std::sin(elevation);
  compact::Sight sight;
  sight.origin = origin_of(rows);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    ranges[i] = kNan;
    if (!std::isfinite(row) || !std::isfinite(columns[i])) continue;
    const double column = lattice_.within_turn(columns[i]);
    const double azimuth = lattice_.azimuth(column);
    sight.direction = to_direction(flat * std::cos(azimuth), flat * std::sin(azimuth), up);
    ranges[i] = range_at(corners_of(rows, column), sight, masked);
  }
}

void CompactField::place_row(double row, std::span<const double> columns,
                             std::span<const double> ranges, std::span<Vec3> points) const {
  if (height_m_.empty()) return Field::place_row(row, columns, ranges, points);
  const double height = height_at(between(row));
  const double base = lattice_.elevation(row);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double r = ranges[i];
    const double azimuth = lattice_.azimuth(lattice_.within_turn(columns[i]));
    const double elevation = base + (!rays_ && r > 0 ? height / r : 0);
    const double flat = std::cos(elevation);
    points[i] = {r * flat * std::cos(azimuth), r * flat * std::sin(azimuth),
                 r * std::sin(elevation)};
    if (!rays_) continue;
    points[i].z += height;
    if (scan_.table.rays->motion.none() || std::isnan(r)) continue;
    points[i] = compact::to_metres(
        compact::moved(to_fixed(points[i]), angle_from_radians(azimuth), scan_.table.rays->motion));
  }
}

std::size_t CompactField::nearest_cell(double row, double column) const {
  if (!rays_) return Field::nearest_cell(row, column);
  const Corners corners = corners_of(between(row), lattice_.within_turn(column));
  const Corner* best = nullptr;
  for (const Corner& corner : corners) {
    if (scan_.range[corner.cell] <= 0 || corner.weight <= 0) continue;
    if (best == nullptr || corner.weight > best->weight) best = &corner;
  }
  if (best != nullptr) return best->cell;
  const std::uint32_t nearest = replacement(corners);
  return nearest == kNoCell ? corners.front().cell : nearest;
}

std::vector<Vec3> CompactField::cell_points() const {
  std::vector<Vec3> points(lattice_.cells(), {kNan, kNan, kNan});
  for (std::uint32_t row = 0; row < lattice_.rows(); ++row) {
    const double elevation = lattice_.elevations()[row];
    const double height = height_m_.empty() ? 0 : height_m_[row];
    const double lateral = rays_ ? metres(scan_.table.rays->rays[row].lateral) : 0;
    for (std::uint32_t column = 0; column < lattice_.columns(); ++column) {
      const std::size_t at = cell(row, column);
      if (scan_.range[at] <= 0) continue;
      const double range = metres(std::max(scan_.range[at] - offset(row), 1));
      const double azimuth = rays_ ? radians_from_angle(static_cast<std::int32_t>(
                                         scan_.table.rays->azimuth_of(row, column)))
                                   : lattice_.azimuth(column);
      const double up = rays_ ? elevation : elevation + height / range;
      const double out = range * std::cos(up), c = std::cos(azimuth), s = std::sin(azimuth);
      points[at] = {out * c - lateral * s, out * s + lateral * c,
                    range * std::sin(up) + (rays_ ? height : 0)};
    }
  }
  return points;
}

double CompactField::step_m() const {
  // Where there is a residual layer, and all of it is here, it has the last word.
  const compact::ScanParameters& parameters = scan_.parameters;
  const bool refined =
      parameters.residual_step > 0 && scan_.missing.empty() &&
      std::all_of(scan_.segments.begin(), scan_.segments.end(),
                  [](const compact::DecodedSegment& s) { return s.residual_rows > 0; });
  return metres(refined ? std::min(parameters.residual_step, parameters.step) : parameters.step);
}

double CompactField::ring_offset_m(std::uint32_t row) const {
  return scan_.table.range_offset.empty() ? 0 : metres(scan_.table.range_offset[row]);
}

RowLine CompactField::row_line(double row) const {
  const double elevation = lattice_.elevation(row), height = height_at(between(row));
  // A point at range r of a row with a height is seen at elevation + height / r: on a line that
  // passes the origin at that distance.
  return rays_ ? RowLine{elevation, height, false}
               : RowLine{elevation, height / std::cos(elevation), true};
}

RigidMotion CompactField::motion_at(double azimuth) const {
  return moves() ? rigid_motion(scan_.table.rays->motion, azimuth) : RigidMotion{};
}

void EmptyField::evaluate_row(double, std::span<const double>, bool,
                              std::span<double> ranges) const {
  std::fill(ranges.begin(), ranges.end(), kNan);
}

}  // namespace curlidar
