// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/parallel.hpp"

namespace curlidar {
namespace {

/// Where a field is asked along one of its own lines.
struct Aim {
  double row = 0, column = 0;
};

double range_of(const Field& field, const Aim& aim, bool masked) {
  double range = std::numeric_limits<double>::quiet_NaN();
  field.evaluate_row(aim.row, std::span(&aim.column, 1), masked, std::span(&range, 1));
  return range;
}

Vec3 point_of(const Field& field, const Aim& aim, double range) {
  Vec3 point;
  field.place_row(aim.row, std::span(&aim.column, 1), std::span(&range, 1), std::span(&point, 1));
  return point;
}

/// Where a field must be asked for its point to lie on a line of sight. Fixed-point iteration:
/// points are not where the lattice looks if beams start away from the origin or the scan was
/// moved.
Aim aim_along(const Field& field, const Sightline& line) {
  constexpr int kSteps = 6;
  constexpr double kClose = 1e-7;      // radians
  constexpr double kSomewhere_m = 10;  // where the field says nothing
  const Lattice& lattice = field.lattice();
  const double elevation = elevation_of(line.direction), azimuth = azimuth_of(line.direction);
  double row_elevation = elevation, column_azimuth = azimuth;
  Aim aim{lattice.row_of(elevation), lattice.column_of(azimuth)};
  for (int step = 0; step < kSteps; ++step) {
    const double told = range_of(field, aim, false);
    const Vec3 point = point_of(field, aim, told > 0 ? told : kSomewhere_m) - line.origin;
    const double up = elevation - elevation_of(point);
    const double left = std::remainder(azimuth - azimuth_of(point), 2 * std::numbers::pi);
    if (std::abs(up) < kClose && std::abs(left) < kClose) break;
    row_elevation += up;
    column_azimuth += left;
    aim = {lattice.row_of(row_elevation), lattice.column_of(column_azimuth)};
  }
  return aim;
}

RangeEstimate estimate_along(const Field& field, const Sightline& line) {
  RangeEstimate estimate;
  const Aim aim = aim_along(field, line);
  if (!(aim.row >= 0 && aim.row <= field.lattice().rows() - 1)) return estimate;
  const double masked = range_of(field, aim, true);
  const double range = std::isnan(masked) ? range_of(field, aim, false) : masked;
  if (std::isnan(range)) return estimate;
  estimate.range_m = norm(point_of(field, aim, range) - line.origin);
  estimate.seen = std::isnan(masked) ? Seen::unknown : Seen::surface;
  return estimate;
}

}  // namespace

void Field::range_along(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                        std::size_t threads) const {
  constexpr std::size_t kChunk = 4096;
  parallel_for((lines.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    const std::size_t end = std::min(lines.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      estimates[i] = estimate_along(*this, lines[i]);
    }
  });
}

void Field::range_at(std::span<const Vec3> directions, std::span<RangeEstimate> estimates,
                     std::size_t threads) const {
  std::vector<Sightline> lines(directions.size());
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].direction = directions[i];
  range_along(lines, estimates, threads);
}

Sources Field::sources_at(const Vec3& point) const {
  const Aim aim = aim_along(*this, {{}, point});
  Sources sources;
  sources.cell[0] = nearest_cell(aim.row, aim.column);
  sources.weight[0] = 1;
  return sources;
}

void Field::place_row(double row, std::span<const double> columns, std::span<const double> ranges,
                      std::span<Vec3> points) const {
  const double elevation = lattice().elevation(row);
  const double flat = std::cos(elevation), up = std::sin(elevation);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double azimuth = lattice().azimuth(columns[i]), r = ranges[i];
    points[i] = {r * flat * std::cos(azimuth), r * flat * std::sin(azimuth), r * up};
  }
}

std::size_t Field::nearest_cell(double row, double column) const {
  const std::size_t rows = lattice().rows(), width = lattice().columns();
  const double inside = std::fmin(std::fmax(std::round(row), 0.0), static_cast<double>(rows - 1));
  return static_cast<std::size_t>(inside) * width +
         static_cast<std::size_t>(std::round(lattice().within_turn(column))) % width;
}

std::vector<Vec3> Field::cell_points() const {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::uint32_t width = lattice().columns();
  std::vector<double> columns(width), ranges(width);
  for (std::uint32_t column = 0; column < width; ++column) columns[column] = column;
  std::vector<Vec3> points(lattice().cells());
  for (std::uint32_t row = 0; row < lattice().rows(); ++row) {
    evaluate_row(row, columns, false, ranges);
    const std::span line = std::span(points).subspan(std::size_t{row} * width, width);
    place_row(row, columns, ranges, line);
    for (std::uint32_t column = 0; column < width; ++column) {
      if (!occupied(row, column)) line[column] = {kNan, kNan, kNan};
    }
  }
  return points;
}

double Field::ring_offset_m(std::uint32_t) const {
  return 0;
}

RowLine Field::row_line(double row) const {
  return {.elevation = lattice().elevation(row)};
}

RigidMotion Field::motion_at(double) const {
  return {};
}

}  // namespace curlidar
