// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/sampler.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "base/try.hpp"

namespace curlidar::bench {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool on_row(double index) {
  return std::abs(index - std::round(index)) < 1e-9;
}

double range_at(const Field& field, const Aim& aim, bool masked) {
  double range = kNan;
  field.evaluate_row(aim.row, std::span(&aim.column, 1), masked, std::span(&range, 1));
  return range;
}

Vec3 point_at(const Field& field, const Aim& aim, double range) {
  Vec3 point;
  field.place_row(aim.row, std::span(&aim.column, 1), std::span(&range, 1), std::span(&point, 1));
  return point;
}

}  // namespace

Aim aim_at(const Field& field, const Vec3& direction) {
  constexpr int kSteps = 6;
  constexpr double kClose = 1e-7;      // radians
  constexpr double kSomewhere_m = 10;  // where the field says nothing
  const Lattice& lattice = field.lattice();
  const double elevation = elevation_of(direction), azimuth = azimuth_of(direction);
  double row_elevation = elevation, column_azimuth = azimuth;
  Aim aim{lattice.row_of(elevation), lattice.column_of(azimuth)};
  for (int step = 0; step < kSteps; ++step) {
    const double told = range_at(field, aim, false);
    const Vec3 point = point_at(field, aim, told > 0 ? told : kSomewhere_m);
    const double up = elevation - elevation_of(point);
    const double left = std::remainder(azimuth - azimuth_of(point), 2 * std::numbers::pi);
    if (std::abs(up) < kClose && std::abs(left) < kClose) break;
    row_elevation += up;
    column_azimuth += left;
    aim = {lattice.row_of(row_elevation), lattice.column_of(column_azimuth)};
  }
  return aim;
}

double FieldSampler::range(const Vec3& direction) const {
  const Field& field = *scan_.field;
  const Aim aim = aim_at(field, direction);
  if (!(aim.row >= 0 && aim.row <= field.lattice().rows() - 1)) return kNan;
  const double range = range_at(field, aim, true);
  return std::isnan(range) ? kNan : norm(point_at(field, aim, range));
}

Result<std::vector<RayRange>> FieldSampler::between_rows(double factor) const {
  const Lattice& lattice = scan_.field->lattice();
  const DenseGrid grid(lattice, factor, 1);
  CURLIDAR_TRY_ASSIGN(cloud, reconstruct(scan_, {.rows = factor, .organised = true}));
  std::vector<RayRange> rays;
  for (std::size_t i = 0; i < grid.rows; ++i) {
    const double row = grid.row(i);
    if (on_row(row) || row < 0) continue;
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const Vec3& p = cloud.positions[i * grid.columns + j];
      if (is_return(p)) {
        rays.push_back({p * (1 / norm(p)), norm(p)});
      } else {
        rays.push_back({lattice.direction(row, grid.column(j)), kNan});
      }
    }
  }
  return rays;
}

Result<std::vector<RayRange>> RingSampler::between_rows(double factor) const {
  const Lattice lattice = Lattice::from_rings(samples_->elevations(), samples_->columns());
  const DenseGrid grid(lattice, factor, 1);
  std::vector<RayRange> rays;
  for (std::size_t i = 0; i < grid.rows; ++i) {
    const double row = grid.row(i);
    if (on_row(row) || row < 0) continue;
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const Vec3 direction = lattice.direction(row, grid.column(j));
      rays.push_back({direction, range(direction)});
    }
  }
  return rays;
}

}  // namespace curlidar::bench
