// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/jumps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace curlidar::bench {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Every n-th so that at most `most` stay.
std::vector<CellPair> thinned(const std::vector<CellPair>& pairs, std::size_t most) {
  const std::size_t stride = (pairs.size() + most - 1) / std::max<std::size_t>(most, 1);
  std::vector<CellPair> kept;
  for (std::size_t i = 0; i < pairs.size(); i += std::max<std::size_t>(stride, 1)) {
    kept.push_back(pairs[i]);
  }
  return kept;
}

}  // namespace

Cells::Cells(std::shared_ptr<const Field> field)
    : field_(std::move(field)), points_(field_->cell_points()) {}

Cells::View Cells::view(std::size_t cell) const {
  const auto row = static_cast<double>(cell / field_->lattice().columns());
  const double height_m = field_->row_line(row).height_m;
  const Vec3 along = points_[cell] - Vec3{0, 0, height_m};
  return {azimuth_of(along), elevation_of(along), height_m};
}

double Cells::row_step(std::size_t cell) const {
  const auto row = static_cast<double>(cell / field_->lattice().columns());
  return field_->lattice().elevation(row) - field_->lattice().elevation(row + 1);
}

/// Cells of rays may lie degrees apart although their indices follow each other.
bool Cells::look_alike(std::size_t a, std::size_t b) const {
  constexpr double kSteps = 1.5;
  const View from = view(a), to = view(b);
  const double apart =
      norm(direction_of(from.elevation, from.azimuth) - direction_of(to.elevation, to.azimuth));
  return apart <= kSteps * std::max(kTurn / field_->lattice().columns(), row_step(a));
}

std::vector<CellPair> Cells::pairs(std::span<const std::uint32_t> block, std::size_t most) const {
  const std::size_t columns = field_->lattice().columns();
  std::vector<CellPair> borders, insides;
  const auto add = [&](std::size_t from, std::size_t to) {
    if (to >= points_.size() || std::isnan(points_[to].x) || !look_alike(from, to)) return;
    const bool border = block[from] != block[to];
    (border ? borders : insides).push_back({from, to, border});
  };
  for (std::size_t cell = 0; cell < points_.size(); ++cell) {
    if (std::isnan(points_[cell].x)) continue;
    if ((cell + 1) % columns != 0) add(cell, cell + 1);
    add(cell, cell + columns);
  }
  std::vector<CellPair> pairs = thinned(borders, most);
  const std::vector<CellPair> within = thinned(insides, most);
  pairs.insert(pairs.end(), within.begin(), within.end());
  return pairs;
}

Way Cells::way(const CellPair& pair) const {
  const View from = view(pair.from), to = view(pair.to);
  const double turn = std::remainder(to.azimuth - from.azimuth, kTurn);
  Way way;
  for (std::size_t i = 0; i < kStops; ++i) {
    const double part = static_cast<double>(i) / (kStops - 1);
    const double azimuth = std::remainder(from.azimuth + part * turn, kTurn);
    const double elevation = from.elevation + part * (to.elevation - from.elevation);
    const double height_m = from.height_m + part * (to.height_m - from.height_m);
    const RigidMotion motion = field_->motion_at(azimuth);
    way[i] = {motion({0, 0, height_m}), motion.turned(direction_of(elevation, azimuth))};
  }
  return way;
}

std::vector<std::size_t> Cells::around(const CellPair& pair) const {
  constexpr std::size_t kReach = 6;  // columns; rays of neighbouring ones may look in any order
  const std::size_t columns = field_->lattice().columns();
  const double begin = view(pair.from).azimuth;
  const double turn = std::remainder(view(pair.to).azimuth - begin, kTurn);
  const double right = std::min(turn, 0.0), left = std::max(turn, 0.0);
  std::vector<std::size_t> cells{pair.from, pair.to};
  const auto add_row = [&](std::size_t row, std::size_t column) {
    std::optional<std::size_t> before, behind;
    double most = -kTurn, least = kTurn;
    for (std::size_t step = 0; step <= 2 * kReach; ++step) {
      const std::size_t cell = row * columns + (column + columns + step - kReach) % columns;
      if (std::isnan(points_[cell].x)) continue;
      const double at = std::remainder(view(cell).azimuth - begin, kTurn);
      if (at >= right && at <= left) cells.push_back(cell);
      if (at < right && at > most) most = at, before = cell;
      if (at > left && at < least) least = at, behind = cell;
    }
    if (pair.to == pair.from + 1) return;
    if (before) cells.push_back(*before);
    if (behind) cells.push_back(*behind);
  };
  add_row(pair.from / columns, pair.from % columns);
  if (pair.to != pair.from + 1) add_row(pair.to / columns, pair.to % columns);
  return cells;
}

Vec3 Cells::coded(std::size_t cell) const {
  return field_->motion_at(azimuth_of(points_[cell]))(points_[cell]);
}

WayRanges ranges_along(const Field& field, const Way& way) {
  std::array<RangeEstimate, kStops> told;
  field.range_along(way, told);
  WayRanges ranges_m;
  std::transform(told.begin(), told.end(), ranges_m.begin(), [](const RangeEstimate& estimate) {
    return estimate.valid() ? estimate.range_m : std::numeric_limits<double>::quiet_NaN();
  });
  return ranges_m;
}

double jump_of(const WayRanges& ranges_m) {
  constexpr double kSteps = kStops - 1;
  double largest = 0, jump_m = 0;
  for (std::size_t i = 0; i < kStops; ++i) {
    if (!(ranges_m[i] > 0)) return std::numeric_limits<double>::quiet_NaN();
    if (i == 0) continue;
    const double step = std::abs(1 / ranges_m[i] - 1 / ranges_m[i - 1]);
    if (step <= largest) continue;
    largest = step;
    jump_m = std::abs(ranges_m[i] - ranges_m[i - 1]);
  }
  if (largest == 0) return 0;
  const double even = std::abs(1 / ranges_m.back() - 1 / ranges_m.front()) / kSteps;
  return jump_m * std::max(0.0, (1 - even / largest) * kSteps / (kSteps - 1));
}

}  // namespace curlidar::bench
