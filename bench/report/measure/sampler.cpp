// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/sampler.hpp"

#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "base/try.hpp"
#include "curlidar/reconstruct.hpp"

namespace curlidar::bench {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool on_row(double index) {
  return std::abs(index - std::round(index)) < 1e-9;
}

}  // namespace

double FieldSampler::range(const Vec3& direction) const {
  RangeEstimate estimate;
  scan_.field->range_at(std::span(&direction, 1), std::span(&estimate, 1));
  return estimate.valid() ? estimate.range_m : kNan;
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
