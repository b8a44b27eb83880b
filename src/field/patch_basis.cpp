// SPDX-License-Identifier: BSD-3-Clause
#include "field/patch_basis.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curlidar {
namespace {

/// A function whose part independent of the earlier ones is smaller than this share of itself
/// carries rounding errors only.
constexpr double kDependent = 1e-7;

/// Exponent of `down` and order m of each polynomial of one degree, cosine before sine.
struct Polynomial {
  std::size_t down = 0, order = 0;
  bool sine = false;
};

template <class Visit>
void for_each_polynomial(std::size_t degree, const Visit& visit) {
  for (std::size_t i = 0; i <= degree; ++i) {
    const std::size_t order = degree - i;
    visit(Polynomial{i, order, false});
    if (order > 0) visit(Polynomial{i, order, true});
  }
}

double power(double base, std::size_t exponent) {
  double result = 1;
  for (std::size_t i = 0; i < exponent; ++i) result *= base;
  return result;
}

double value_of(const Polynomial& p, const LocalDirection& d) {
  double re = 1, im = 0;
  for (std::size_t i = 0; i < p.order; ++i) {
    const double next = re * d.east - im * d.north;
    im = re * d.north + im * d.east;
    re = next;
  }
  return power(d.down, p.down) * (p.sine ? im : re);
}

double mean_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum / static_cast<double>(a.size());
}

}  // namespace

AngleParts AngleParts::of(double angle) {
  return {std::sin(angle), std::cos(angle)};
}

LocalDirection LocalFrame::local(const AngleParts& elevation, const AngleParts& half) const {
  const double sine = 2 * half.sin * half.cos;     // of the azimuth difference
  const double versine = 2 * half.sin * half.sin;  // one minus its cosine
  const double sin_up = elevation.sin * centre_.cos - elevation.cos * centre_.sin;
  const double cos_up = elevation.cos * centre_.cos + elevation.sin * centre_.sin;
  // 1 - cos(a) = sin(a)^2 / (1 + cos(a)) keeps its digits for the small angles of a patch.
  const double up_versine = cos_up > 0 ? sin_up * sin_up / (1 + cos_up) : 1 - cos_up;
  return {elevation.cos * sine, sin_up + elevation.cos * centre_.sin * versine,
          up_versine + elevation.cos * centre_.cos * versine};
}

PatchBasis::PatchBasis(std::vector<LocalDirection> cells) : cells_(std::move(cells)) {
  double tangent = 0, down = 0;
  for (const LocalDirection& d : cells_) {
    tangent = std::max({tangent, std::abs(d.east), std::abs(d.north)});
    down = std::max(down, d.down);
  }
  if (tangent > 0) tangent_scale_ = tangent;  // a patch of one cell has no extent
  if (down > 0) down_scale_ = down;
  add_degree();
}

void PatchBasis::extend(std::size_t degree) {
  while (this->degree() < degree && !complete()) add_degree();
}

std::size_t PatchBasis::degree_with(std::size_t count) {
  std::size_t wanted = 0;
  for (; functions(wanted) < count; ++wanted) {
    if (wanted == degree()) {
      if (complete()) break;
      add_degree();
    }
  }
  return wanted;
}

void PatchBasis::add_degree() {
  const std::size_t degree = ends_.size();
  std::size_t polynomial = degree * degree;
  for_each_polynomial(degree, [&](const Polynomial& p) {
    const std::size_t index = polynomial++;
    if (full()) return;
    std::vector<double> column(cells_.size());
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const LocalDirection& d = cells_[i];
      column[i] =
          value_of(p, {d.east / tangent_scale_, d.north / tangent_scale_, d.down / down_scale_});
    }
    const double before = std::sqrt(mean_product(column, column));
    std::vector<double> weights(columns_.size() + 1, 0);
    for (int pass = 0; pass < 2; ++pass) {  // twice is enough (Kahan, Parlett)
      for (std::size_t k = 0; k < columns_.size(); ++k) {
        const double share = mean_product(column, columns_[k]);
        weights[k] += share;
        for (std::size_t i = 0; i < column.size(); ++i) column[i] -= share * columns_[k][i];
      }
    }
    const double after = std::sqrt(mean_product(column, column));
    if (!(after > kDependent * before)) return;
    for (double& v : column) v /= after;
    weights.back() = after;
    columns_.push_back(std::move(column));
    triangle_.push_back(std::move(weights));
    polynomial_.push_back(index);
  });
  ends_.push_back(columns_.size());
}

std::vector<double> PatchBasis::to_local(std::span<const double> coefficients,
                                         std::size_t degree) const {
  std::vector<double> rest(coefficients.begin(), coefficients.end());
  std::vector<double> local(harmonics_up_to(degree), 0.0);
  for (std::size_t k = rest.size(); k-- > 0;) {  // back substitution
    const double weight = rest[k] / triangle_[k].back();
    for (std::size_t j = 0; j < k; ++j) rest[j] -= weight * triangle_[k][j];
    local[polynomial_[k]] = weight;
  }
  for (std::size_t l = 0, index = 0; l <= degree; ++l) {
    for_each_polynomial(l, [&](const Polynomial& p) {
      local[index++] /= power(tangent_scale_, p.order) * power(down_scale_, p.down);
    });
  }
  return local;
}

double evaluate_local(std::span<const double> a, const LocalDirection& d) {
  double sum = a[0];
  if (a.size() >= 4) sum += a[1] * d.east + a[2] * d.north + a[3] * d.down;
  if (a.size() <= 4) return sum;
  // zeta^m for the orders met so far; polynomials of degree l need orders up to l.
  constexpr std::size_t kMaxStack = 32;
  double re_stack[kMaxStack], im_stack[kMaxStack];
  const auto degree =
      static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(a.size())))) - 1;
  std::vector<double> heap(degree >= kMaxStack ? 2 * (degree + 1) : 0);
  double* re = heap.empty() ? re_stack : heap.data();
  double* im = heap.empty() ? im_stack : heap.data() + degree + 1;
  re[0] = 1, im[0] = 0;
  for (std::size_t m = 1; m <= degree; ++m) {
    re[m] = re[m - 1] * d.east - im[m - 1] * d.north;
    im[m] = re[m - 1] * d.north + im[m - 1] * d.east;
  }
  for (std::size_t l = 2, index = 4; l <= degree; ++l) {
    double down = 1;
    for (std::size_t i = 0; i <= l; ++i, down *= d.down) {
      const std::size_t m = l - i;
      sum += a[index++] * down * re[m];
      if (m > 0) sum += a[index++] * down * im[m];
    }
  }
  return sum;
}

}  // namespace curlidar
