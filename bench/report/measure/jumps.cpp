// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/jumps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace curlidar::bench {
namespace {

/// Every n-th so that at most `most` stay.
std::vector<CellPair> thinned(const std::vector<CellPair>& pairs, std::size_t most) {
  const std::size_t stride = (pairs.size() + most - 1) / std::max<std::size_t>(most, 1);
  std::vector<CellPair> kept;
  for (std::size_t i = 0; i < pairs.size(); i += std::max<std::size_t>(stride, 1)) {
    kept.push_back(pairs[i]);
  }
  return kept;
}

/// Whether the cells of a pair look almost the same way: those of a ray lattice may lie degrees
/// apart although their indices follow each other.
bool look_alike(const Field& field, const CellPair& pair) {
  constexpr double kSteps = 1.5;
  static constexpr double kSomewhere_m = 10;
  const Lattice& lattice = field.lattice();
  const auto place = [&](double row, double column) {
    Vec3 point;
    field.place_row(row, std::span(&column, 1), std::span(&kSomewhere_m, 1), std::span(&point, 1));
    return point * (1 / norm(point));
  };
  const double down = pair.down ? 1 : 0;
  const double apart =
      norm(place(pair.row, pair.column) - place(pair.row + down, pair.column + 1 - down));
  const double row_step = lattice.elevation(pair.row) - lattice.elevation(pair.row + down);
  return apart <= kSteps * std::max(2 * std::numbers::pi / lattice.columns(), row_step);
}

}  // namespace

std::vector<CellPair> cell_pairs(const Field& field, std::span<const std::uint32_t> block,
                                 std::size_t most) {
  const std::uint32_t rows = field.lattice().rows(), columns = field.lattice().columns();
  const auto block_of = [&](std::uint32_t row, std::uint32_t column) {
    return block[std::size_t{row} * columns + column];
  };
  std::vector<CellPair> borders, insides;
  const auto add = [&](CellPair pair, std::uint32_t row, std::uint32_t column) {
    if (!field.occupied(row, column) || !look_alike(field, pair)) return;
    pair.border = block_of(pair.row, pair.column) != block_of(row, column);
    (pair.border ? borders : insides).push_back(pair);
  };
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      if (!field.occupied(row, column)) continue;
      if (column + 1 < columns) add({row, column, false, false}, row, column + 1);
      if (row + 1 < rows) add({row, column, true, false}, row + 1, column);
    }
  }
  std::vector<CellPair> pairs = thinned(borders, most);
  const std::vector<CellPair> within = thinned(insides, most);
  pairs.insert(pairs.end(), within.begin(), within.end());
  return pairs;
}

std::array<Vec3, kStops> way_between(const Field& field, const CellPair& pair) {
  std::array<Vec3, kStops> points;
  for (std::size_t i = 0; i < kStops; ++i) {
    const double part = static_cast<double>(i) / (kStops - 1);
    const double row = pair.row + (pair.down ? part : 0);
    const double column = pair.column + (pair.down ? 0 : part);
    double range_m = std::numeric_limits<double>::quiet_NaN();
    field.evaluate_row(row, std::span(&column, 1), true, std::span(&range_m, 1));
    field.place_row(row, std::span(&column, 1), std::span(&range_m, 1), std::span(&points[i], 1));
  }
  return points;
}

double jump_of(const std::array<double, kStops>& ranges_m) {
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
