// SPDX-License-Identifier: BSD-3-Clause
#include "paper/global_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>

#include "base/parallel.hpp"
#include "field/spherical_harmonics.hpp"

namespace curlidar {
namespace {

constexpr double kRidge = 1e-12;

/// cos(m phi) or sin(m phi). Number t of a degree L expansion: cosines 0..L, then sines 1..L.
struct Wave {
  std::size_t order;
  bool sine;

  static Wave number(std::size_t t, std::size_t degree) {
    return t <= degree ? Wave{t, false} : Wave{t - degree, true};
  }
};

std::size_t harmonic_index(std::size_t l, const Wave& w) {
  return w.sine ? l * l + l - w.order : l * l + l + w.order;
}

/// Sums over the samples of one row of cos(k phi) and sin(k phi), plain and times the range.
struct RowSums {
  std::vector<double> cosine, sine;              ///< k = 0..2 degree
  std::vector<double> range_cosine, range_sine;  ///< k = 0..degree

  /// Sum over the samples of the product of two waves.
  double product(const Wave& a, const Wave& b) const {
    const std::size_t sum = a.order + b.order;
    const std::size_t difference = a.order > b.order ? a.order - b.order : b.order - a.order;
    if (!a.sine && !b.sine) return 0.5 * (cosine[difference] + cosine[sum]);
    if (a.sine && b.sine) return 0.5 * (cosine[difference] - cosine[sum]);
    const double half_difference = 0.5 * sine[difference];
    const bool sine_is_higher = a.sine ? a.order >= b.order : b.order >= a.order;
    return 0.5 * sine[sum] + (sine_is_higher ? half_difference : -half_difference);
  }
  double with_range(const Wave& w) const {
    return w.sine ? range_sine[w.order] : range_cosine[w.order];
  }
};

RowSums sum_row(const double* ranges, std::size_t columns, double first_azimuth, double step,
                std::size_t degree) {
  RowSums sums;
  sums.cosine.assign(2 * degree + 1, 0);
  sums.sine.assign(2 * degree + 1, 0);
  sums.range_cosine.assign(degree + 1, 0);
  sums.range_sine.assign(degree + 1, 0);
  for (std::size_t j = 0; j < columns; ++j) {
    if (ranges[j] <= 0) continue;
    const double azimuth = first_azimuth + static_cast<double>(j) * step;
    for (std::size_t k = 0; k <= 2 * degree; ++k) {
      const double c = std::cos(static_cast<double>(k) * azimuth);
      const double s = std::sin(static_cast<double>(k) * azimuth);
      sums.cosine[k] += c;
      sums.sine[k] += s;
      if (k > degree) continue;
      sums.range_cosine[k] += ranges[j] * c;
      sums.range_sine[k] += ranges[j] * s;
    }
  }
  return sums;
}

/// Legendre values of every dense row, and the row's sums.
struct DenseRows {
  std::vector<std::vector<double>> legendre;
  std::vector<RowSums> sums;
};

DenseRows sum_rows(const SampleImage& samples, const Lattice& lattice, std::size_t degree,
                   std::size_t threads) {
  DenseRows rows{std::vector<std::vector<double>>(samples.rows),
                 std::vector<RowSums>(samples.rows)};
  const DenseGrid grid(lattice, samples.row_factor, samples.column_factor);
  parallel_for(samples.rows, threads, [&](std::size_t i) {
    const double elevation = lattice.elevation(grid.row(i));
    rows.legendre[i] = legendre(degree, std::sin(elevation), std::cos(elevation));
    rows.sums[i] =
        sum_row(samples.range.data() + samples.index(i, 0), samples.columns, lattice.azimuth(0),
                lattice.azimuth(grid.column(1)) - lattice.azimuth(0), degree);
  });
  return rows;
}

std::vector<double> solve_normal_equations(const DenseRows& rows, std::size_t degree,
                                           std::size_t threads) {
  const auto unknowns = static_cast<Eigen::Index>((degree + 1) * (degree + 1));
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  const std::size_t waves = 2 * degree + 1;
  const std::size_t row_count = rows.sums.size();
  parallel_for(waves, threads, [&](std::size_t s) {
    const Wave a = Wave::number(s, degree);
    for (std::size_t t = 0; t <= s; ++t) {
      const Wave b = Wave::number(t, degree);
      for (std::size_t i = 0; i < row_count; ++i) {
        const double weight = rows.sums[i].product(a, b);
        if (weight == 0) continue;
        for (std::size_t l = a.order; l <= degree; ++l) {
          const double scaled = weight * rows.legendre[i][legendre_index(l, a.order)];
          const auto row = static_cast<Eigen::Index>(harmonic_index(l, a));
          const std::size_t last = s == t ? l : degree;  // each pair of one wave once
          for (std::size_t k = b.order; k <= last; ++k) {
            const auto column = static_cast<Eigen::Index>(harmonic_index(k, b));
            normal(std::max(row, column), std::min(row, column)) +=
                scaled * rows.legendre[i][legendre_index(k, b.order)];
          }
        }
      }
    }
    for (std::size_t i = 0; i < row_count; ++i) {
      for (std::size_t l = a.order; l <= degree; ++l) {
        right[static_cast<Eigen::Index>(harmonic_index(l, a))] +=
            rows.sums[i].with_range(a) * rows.legendre[i][legendre_index(l, a.order)];
      }
    }
  });
  const double ridge = kRidge * normal.diagonal().mean();
  normal.diagonal().array() += ridge > 0 ? ridge : 1;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(normal);
  const Eigen::VectorXd solution = factor.solve(right);
  return {solution.begin(), solution.end()};
}

}  // namespace

GlobalModel fit_global(const PaperStages& stages, const PaperSettings& settings,
                       std::size_t threads, const ProgressCallback& progress) {
  GlobalModel model{stages.image.lattice, settings, stages.masks, {}};
  const auto& range = stages.image.range;
  model.settings.max_range = {range.empty() ? 0 : *std::max_element(range.begin(), range.end()), 0};
  const std::size_t degree = settings.global_degree;
  const DenseRows rows = sum_rows(stages.samples, model.lattice, degree, threads);
  if (progress) progress("fit", 0.7);
  model.coefficients = solve_normal_equations(rows, degree, threads);
  if (progress) progress("fit", 0.9);
  std::vector<double> columns(model.lattice.columns()), fitted(columns.size());
  for (std::size_t j = 0; j < columns.size(); ++j) columns[j] = static_cast<double>(j);
  const GlobalField field(model);
  for (std::uint32_t row = 0; row < model.lattice.rows(); ++row) {
    field.evaluate_row(row, columns, true, fitted);
    for (std::size_t j = 0; j < columns.size(); ++j) {
      const std::size_t cell = stages.image.index(row, j);
      if (model.masks.point[cell] &&
          !(std::abs(fitted[j] - range[cell]) < settings.global_reject_m)) {
        model.masks.point[cell] = 0;
      }
    }
  }
  return model;
}

GlobalField::GlobalField(GlobalModel model)
    : model_(std::move(model)),
      degree_(static_cast<std::size_t>(
                  std::lround(std::sqrt(static_cast<double>(model_.coefficients.size())))) -
              1) {}

void GlobalField::evaluate_row(double row, std::span<const double> columns, bool masked,
                               std::span<double> ranges) const {
  const double elevation = model_.lattice.elevation(row);
  const std::vector<double> p = legendre(degree_, std::sin(elevation), std::cos(elevation));
  std::vector<double> cosine(degree_ + 1, 0), sine(degree_ + 1, 0);
  for (std::size_t m = 0; m <= degree_; ++m) {
    for (std::size_t l = m; l <= degree_; ++l) {
      cosine[m] += model_.coefficients[l * l + l + m] * p[legendre_index(l, m)];
      if (m > 0) sine[m] += model_.coefficients[l * l + l - m] * p[legendre_index(l, m)];
    }
  }
  const double low = model_.settings.min_range_m - model_.settings.global_reject_m;
  const double high = model_.settings.max_range.metres + model_.settings.global_reject_m;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    ranges[i] = std::numeric_limits<double>::quiet_NaN();
    if (!is_index(row) || !is_index(columns[i])) continue;
    if (masked && !believed(model_.masks, CellPosition::of(row, columns[i]))) continue;
    const double azimuth = model_.lattice.azimuth(columns[i]);
    double value = cosine[0], re = 1, im = 0;
    const double c = std::cos(azimuth), s = std::sin(azimuth);
    for (std::size_t m = 1; m <= degree_; ++m) {
      const double next = re * c - im * s;
      im = re * s + im * c;
      re = next;
      value += cosine[m] * re + sine[m] * im;
    }
    if (value > 0 && value >= low && value <= high) ranges[i] = value;
  }
}

}  // namespace curlidar
