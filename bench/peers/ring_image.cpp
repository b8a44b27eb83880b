// SPDX-License-Identifier: BSD-3-Clause
// The range image of a raw scan that treats the peers best: rows are the true rings, each a cone of
// its own tip, and a row's columns lie where its returns do.
#include <cmath>
#include <limits>
#include <numbers>

#include "curlidar/sensor.hpp"
#include "peers.hpp"

namespace curlidar::bench {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

struct Member {
  double distance_m;  ///< from the spin axis
  double z_m;
  double azimuth;  ///< in [0, 2 pi)
  double range_m;
};
using Row = std::vector<Member>;

std::vector<Row> rows_of(const Cloud& cloud, const Detection& found) {
  std::vector<Row> rows(found.sensor.rings.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.positions[i];
    if (!is_return(p) || found.ring_of_point[i] >= rows.size()) continue;
    const double azimuth = std::atan2(p.y, p.x);
    rows[found.ring_of_point[i]].push_back(
        {std::hypot(p.x, p.y), p.z, azimuth < 0 ? azimuth + kTurn : azimuth, norm(p)});
  }
  return rows;
}

/// z = height + slope * distance.
struct Cone {
  double height_m = 0, slope = 0;
  double z(double distance_m) const { return height_m + slope * distance_m; }
};

/// Least squares of the angle's error, so that far returns do not outweigh near ones. Returns that
/// are much farther off than most (of another ring, say) are left out of the next round.
Cone fit_cone(const Row& row) {
  Cone cone;
  double tolerance = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 4; ++round) {
    double w = 0, wd = 0, wdd = 0, wz = 0, wdz = 0;
    for (const Member& m : row) {
      const double weight = 1 / (m.range_m * m.range_m);
      if (std::abs(m.z_m - cone.z(m.distance_m)) / m.range_m > tolerance) continue;
      w += weight;
      wd += weight * m.distance_m;
      wdd += weight * m.distance_m * m.distance_m;
      wz += weight * m.z_m;
      wdz += weight * m.distance_m * m.z_m;
    }
    const double determinant = w * wdd - wd * wd;
    if (determinant < 1e-9 * w * wdd) {  // all at one distance: the tip cannot be told
      return {0, wd > 0 ? wz / wd : 0};
    }
    cone.slope = (w * wdz - wd * wz) / determinant;
    cone.height_m = (wz - cone.slope * wd) / w;
    std::vector<double> errors;
    for (const Member& m : row) {
      errors.push_back(std::abs(m.z_m - cone.z(m.distance_m)) / m.range_m);
    }
    tolerance = 4 * percentile(errors, .5) + 1e-9;
  }
  return cone;
}

/// Where in its cell the mean return of a row lies, in columns: -0.5 .. 0.5 from the centre.
double phase_of(const Row& row, std::size_t columns) {
  double x = 0, y = 0;
  for (const Member& m : row) {
    const double turns = kTurn * (m.azimuth / kTurn * static_cast<double>(columns) - .5);
    x += std::cos(turns);
    y += std::sin(turns);
  }
  return std::atan2(y, x) / kTurn;
}

/// Of the returns that share a cell, the one nearest its centre stays.
void lay(const Row& row, std::size_t at, Mask& mask, std::vector<Vec3>& points) {
  const Cone cone = fit_cone(row);
  const auto columns = static_cast<double>(mask.columns);
  const double phase = phase_of(row, mask.columns);
  std::vector<double> offsets(mask.columns, 1);
  for (const Member& m : row) {
    const double place = m.azimuth / kTurn * columns - phase;
    const double column = std::floor(place);
    const double offset = std::abs(place - column - .5);
    const auto j = static_cast<std::size_t>(column < 0 ? column + columns : column) % mask.columns;
    if (offset >= offsets[j]) continue;
    offsets[j] = offset;
    const double centre = kTurn * (column + .5 + phase) / columns;
    const Vec3 direction{m.distance_m * std::cos(centre), m.distance_m * std::sin(centre),
                         cone.z(m.distance_m)};
    mask.occupied[at + j] = 1;
    points[at + j] = direction * (m.range_m / norm(direction));
  }
}

}  // namespace

Grid ring_image(const Cloud& cloud, const Detection& found, std::size_t columns) {
  const std::vector<Row> rows = rows_of(cloud, found);
  Grid grid{{rows.size(), columns, std::vector<std::uint8_t>(rows.size() * columns, 0)}, {}, {}};
  std::vector<Vec3> points(grid.mask.occupied.size());
  for (std::size_t i = 0; i < rows.size(); ++i) lay(rows[i], i * columns, grid.mask, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!grid.mask.occupied[i]) continue;
    grid.returns.positions.push_back(points[i]);
    grid.ranges_m.push_back(norm(points[i]));
  }
  return grid;
}

}  // namespace curlidar::bench
