// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_offsets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace curlidar {
namespace {

constexpr double kFarthestM = 30;  ///< beyond, rows lie too far apart to see one surface
constexpr double kMostOffM = 0.5;
constexpr std::size_t kFewestCells = 60;
constexpr double kDamping = 0.15;

/// sin(x) to 1e-6 of itself for the angles between rows.
double small_sine(double x) {
  return x * (1 - x * x / 6 * (1 - x * x / 20));
}

bool smooth(double above, double below) {
  return std::abs(above - below) < 0.1 * std::min(above, below) + 0.5;
}

/// A row's offset against its neighbours': off = up * b[row - 1] + down * b[row + 1] - b[row].
struct Equation {
  bool known = false;
  double off = 0, up = 0, down = 0;
};

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Equation equation_of(const GriddedScan& scan, const RowModel& rows, std::uint32_t row) {
  const auto elevation = [&](std::uint32_t k, double range) {
    return rows.elevation[k] + (rows.height.empty() ? 0 : rows.height[k] / range);
  };
  Equation out;
  std::vector<double> offs;
  for (std::uint32_t column = 0; column < scan.columns; ++column) {
    const double above = scan.range[scan.cell(row - 1, column)];
    const double range = scan.range[scan.cell(row, column)];
    const double below = scan.range[scan.cell(row + 1, column)];
    if (!(above > 0 && range > 0 && below > 0) || range > kFarthestM || !smooth(above, below)) {
      continue;
    }
    const double top = elevation(row - 1, above), middle = elevation(row, range),
                 bottom = elevation(row + 1, below);
    if (!(top > middle && middle > bottom)) continue;
    const double whole = small_sine(top - bottom);
    const double up = small_sine(middle - bottom) / whole, down = small_sine(top - middle) / whole;
    const double expected = 1 / (up / above + down / below);
    if (std::abs(expected - range) >= kMostOffM) continue;
    offs.push_back(expected - range);
    out.up += up * expected * expected / (above * above);
    out.down += down * expected * expected / (below * below);
  }
  if (offs.size() < kFewestCells) return {};
  out.known = true;
  out.up /= static_cast<double>(offs.size());
  out.down /= static_cast<double>(offs.size());
  out.off = median(offs);
  return out;
}

/// Symmetric positive definite equations of bandwidth 2: the diagonal and the two beside it.
class BandedSystem {
 public:
  explicit BandedSystem(std::size_t size) : band_(size, {0, 0, 0}), right_(size, 0) {}

  /// Adds (sum of weights * unknowns - value)^2 to what is least.
  void add(std::size_t first, const std::array<double, 3>& weights, std::size_t count,
           double value) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j <= i; ++j) band_[first + i][i - j] += weights[i] * weights[j];
      right_[first + i] += weights[i] * value;
    }
  }

  std::vector<double> solve() {
    const std::size_t n = band_.size();
    for (std::size_t i = 0; i < n; ++i) {  // Cholesky: band_[i][k] becomes L(i, i - k)
      for (std::size_t k = std::min<std::size_t>(2, i); k > 0; --k) {
        double value = band_[i][k];
        if (k == 1 && i >= 2) value -= band_[i][2] * band_[i - 1][1];
        band_[i][k] = value / band_[i - k][0];
      }
      band_[i][0] = std::sqrt(band_[i][0] - band_[i][1] * band_[i][1] - band_[i][2] * band_[i][2]);
    }
    std::vector<double> x = right_;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 1; k <= std::min<std::size_t>(2, i); ++k) x[i] -= band_[i][k] * x[i - k];
      x[i] /= band_[i][0];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = 1; k <= 2 && i + k < n; ++k) x[i] -= band_[i + k][k] * x[i + k];
      x[i] /= band_[i][0];
    }
    return x;
  }

 private:
  std::vector<std::array<double, 3>> band_;
  std::vector<double> right_;
};

}  // namespace

std::vector<double> estimate_range_offsets(const GriddedScan& scan, const RowModel& rows) {
  BandedSystem system(scan.rows);
  for (std::uint32_t row = 0; row < scan.rows; ++row) {
    system.add(row, {kDamping, 0, 0}, 1, 0);
    if (row == 0 || row + 1 == scan.rows) continue;
    const Equation e = equation_of(scan, rows, row);
    if (e.known) system.add(row - 1, {e.up, -1, e.down}, 3, e.off);
  }
  return system.solve();
}

}  // namespace curlidar
