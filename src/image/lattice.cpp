// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace curlidar {

namespace {
constexpr double kTurn = 2 * std::numbers::pi;
}

Lattice Lattice::uniform(std::uint32_t rows, std::uint32_t columns, double fov_up,
                         double fov_down) {
  Lattice lattice;
  lattice.columns_ = columns;
  lattice.uniform_ = true;
  lattice.elevations_.resize(rows);
  const double step = rows > 1 ? (fov_up - fov_down) / (rows - 1) : 0;
  for (std::uint32_t u = 0; u < rows; ++u)
    lattice.elevations_[u] = fov_down + (rows - 1 - u) * step;
  return lattice;
}

Lattice Lattice::from_rings(std::vector<double> elevations, std::uint32_t columns) {
  Lattice lattice;
  lattice.columns_ = columns;
  lattice.elevations_ = std::move(elevations);
  return lattice;
}

double Lattice::elevation(double row) const {
  if (rows() == 1) return elevations_[0];
  // What is no number has none of the elevations, but a row it is counted from.
  const double base = std::fmin(std::fmax(std::floor(row), 0.0), static_cast<double>(rows() - 2));
  const auto u = static_cast<std::size_t>(base);
  return elevations_[u] + (elevations_[u + 1] - elevations_[u]) * (row - base);
}

double Lattice::azimuth(double column) const {
  return -std::numbers::pi + kTurn * column / static_cast<double>(columns_);
}

double Lattice::row_of(double elevation) const {
  if (rows() == 1) return 0;
  const auto above = std::lower_bound(elevations_.begin(), elevations_.end(), elevation,
                                      [](double e, double target) { return e > target; });
  const auto u = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - elevations_.begin() - 1, 0, rows() - 2));
  return static_cast<double>(u) +
         (elevation - elevations_[u]) / (elevations_[u + 1] - elevations_[u]);
}

double Lattice::column_of(double azimuth) const {
  return within_turn((azimuth + std::numbers::pi) / kTurn * static_cast<double>(columns_));
}

double Lattice::within_turn(double column) const {
  const double within = column - std::floor(column / columns_) * columns_;
  return within >= 0 && within < columns_ ? within : 0;
}

DenseGrid::DenseGrid(const Lattice& lattice, double row_factor_, double column_factor)
    : rows(static_cast<std::uint64_t>(std::max(1.0, std::round(lattice.rows() * row_factor_)))),
      columns(
          static_cast<std::uint64_t>(std::max(1.0, std::round(lattice.columns() * column_factor)))),
      row_factor(row_factor_),
      column_step(static_cast<double>(lattice.columns()) / static_cast<double>(columns)),
      last_row(static_cast<double>(lattice.rows() - 1)) {}

}  // namespace curlidar
