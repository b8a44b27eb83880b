// SPDX-License-Identifier: BSD-3-Clause
#include "dense/ring_points.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "curlidar/cloud.hpp"
#include "dense/patch_joints.hpp"

namespace curlidar {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTurn = 2 * kPi;

void add(std::vector<RingPoint>& ring, const Vec3& p, std::uint32_t cell) {
  const double rho = std::hypot(p.x, p.y);
  if (is_return(p) && rho > 0) ring.push_back({azimuth_of(p), rho, p.z, cell});
}

/// The point moved along its line from a height on the spin axis.
Vec3 moved_out(const Vec3& p, double height_m, double by_m) {
  if (by_m == 0) return p;
  const Vec3 from{0, 0, height_m};
  return from + (p - from) * (1 + by_m / norm(p - from));
}

/// The rows of a lattice from the top; those of files may be in any order.
std::vector<std::uint32_t> from_the_top(const std::vector<double>& elevations) {
  std::vector<std::uint32_t> rows(elevations.size());
  std::iota(rows.begin(), rows.end(), 0U);
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return elevations[a] > elevations[b]; });
  return rows;
}

/// The median step between samples that follow each other; `otherwise` where there are none.
double usual_step(const std::vector<std::vector<RingPoint>>& rings, double otherwise) {
  std::vector<double> steps;
  for (const std::vector<RingPoint>& ring : rings) {
    for (std::size_t i = 1; i < ring.size(); ++i) {
      const double step = ring[i].azimuth - ring[i - 1].azimuth;
      if (step > 0) steps.push_back(step);
    }
  }
  if (steps.empty()) return otherwise;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  // Scans that are mostly gaps do not tell.
  return std::clamp(*middle, otherwise / 2, otherwise * 2);
}

}  // namespace

double turn_between(double from, double to) {
  const double turn = to - from;
  if (turn > kPi) return turn - kTurn;
  return turn < -kPi ? turn + kTurn : turn;
}

RingPoints::RingPoints(const Field& field) : columns_(field.lattice().columns()) {
  const std::vector<Vec3> points = field.cell_points();
  const std::vector<float> joints = patch_joints(field, points);
  rows_ = from_the_top(field.lattice().elevations());
  std::vector<std::vector<RingPoint>> rings(rows_.size());
  for (std::size_t ring = 0; ring < rings.size(); ++ring) {
    const RowLine line = field.row_line(rows_[ring]);
    elevations_.push_back(line.elevation);
    heights_.push_back(line.height_m);
    for (std::uint32_t column = 0; column < columns_; ++column) {
      const std::size_t cell = std::size_t{rows_[ring]} * columns_ + column;
      const double joint_m = joints.empty() ? 0 : joints[cell];
      add(rings[ring], moved_out(points[cell], line.height_m, joint_m),
          static_cast<std::uint32_t>(cell));
    }
  }
  take(std::move(rings));
}

RingPoints::RingPoints(std::span<const Vec3> positions,
                       std::span<const std::uint16_t> ring_of_point, std::vector<double> elevations,
                       std::uint32_t columns)
    : elevations_(std::move(elevations)), heights_(elevations_.size(), 0), columns_(columns) {
  rows_.resize(elevations_.size());
  std::iota(rows_.begin(), rows_.end(), 0U);
  std::vector<std::vector<RingPoint>> rings(rows_.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (ring_of_point[i] < rings.size()) {
      add(rings[ring_of_point[i]], positions[i], static_cast<std::uint32_t>(i));
    }
  }
  take(std::move(rings));
}

void RingPoints::take(std::vector<std::vector<RingPoint>> rings) {
  begin_ = {0};
  fired_.assign(columns_, 0);
  for (std::vector<RingPoint>& ring : rings) {
    std::stable_sort(ring.begin(), ring.end(),
                     [](const RingPoint& a, const RingPoint& b) { return a.azimuth < b.azimuth; });
    std::uint32_t next = 0;
    for (std::size_t at = 0; at < columns_; ++at) {
      while (next < ring.size() && bin(ring[next].azimuth) < at) ++next;
      start_.push_back(next);
    }
    for (const RingPoint& point : ring) fired_[bin(point.azimuth)] = 1;
    points_.insert(points_.end(), ring.begin(), ring.end());
    begin_.push_back(points_.size());
  }
  column_step_ = usual_step(rings, kTurn / columns_);
}

std::size_t RingPoints::bin(double azimuth) const {
  const double at = std::fmax((azimuth + kPi) / kTurn * columns_, 0.0);
  return static_cast<std::size_t>(std::fmin(at, columns_ - 1.0));
}

std::size_t RingPoints::first_beyond(std::size_t ring, double azimuth) const {
  const std::span<const RingPoint> points = this->ring(ring);
  std::size_t at = start_[ring * columns_ + bin(azimuth)];
  while (at < points.size() && points[at].azimuth <= azimuth) ++at;
  return at;
}

std::pair<RingSample, RingSample> RingPoints::around(std::size_t ring, double azimuth) const {
  const std::span<const RingPoint> points = this->ring(ring);
  if (points.empty()) return {};
  const std::size_t beyond = first_beyond(ring, azimuth);
  const RingPoint& before = beyond > 0 ? points[beyond - 1] : points.back();
  const RingPoint& behind = beyond < points.size() ? points[beyond] : points.front();
  const auto ahead = [&](double from, double to) {
    return (to < from ? to - from + kTurn : to - from) / column_step_;
  };
  return {{&before, ahead(before.azimuth, azimuth)}, {&behind, ahead(azimuth, behind.azimuth)}};
}

const RingPoint& RingPoints::walk(std::size_t ring, std::size_t at, std::ptrdiff_t steps) const {
  const std::span<const RingPoint> points = this->ring(ring);
  const auto size = static_cast<std::ptrdiff_t>(points.size());
  const std::ptrdiff_t to = (static_cast<std::ptrdiff_t>(at) + steps) % size;
  return points[static_cast<std::size_t>(to < 0 ? to + size : to)];
}

bool RingPoints::fired(double azimuth) const {
  const std::size_t at = bin(azimuth);
  const std::size_t left = at > 0 ? at - 1 : columns_ - 1;
  const std::size_t right = at + 1 < columns_ ? at + 1 : 0;
  return fired_[left] != 0 || fired_[at] != 0 || fired_[right] != 0;
}

}  // namespace curlidar
