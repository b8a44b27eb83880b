// SPDX-License-Identifier: BSD-3-Clause
#include "paper/fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace curlidar {
namespace {

/// Diagonal entries of the factor below this share of the largest mean that the samples cannot
/// tell the functions apart well enough for normal equations.
constexpr double kWellConditioned = 1e-4;

/// Least squares of `ranges` over the chosen cells with the first `count` functions; of minimum
/// norm where the samples leave freedom.
std::vector<double> solve(const PatchBasis& basis, std::span<const double> ranges,
                          const std::vector<std::uint32_t>& cells, std::size_t count) {
  const auto n = static_cast<Eigen::Index>(cells.size());
  const auto k = static_cast<Eigen::Index>(count);
  Eigen::MatrixXd matrix(n, k);
  Eigen::VectorXd target(n);
  for (Eigen::Index j = 0; j < k; ++j) {
    const std::vector<double>& values = basis.values(static_cast<std::size_t>(j));
    for (Eigen::Index i = 0; i < n; ++i) matrix(i, j) = values[cells[static_cast<std::size_t>(i)]];
  }
  for (Eigen::Index i = 0; i < n; ++i) target[i] = ranges[cells[static_cast<std::size_t>(i)]];
  const Eigen::LLT<Eigen::MatrixXd> normal(Eigen::MatrixXd(matrix.transpose().lazyProduct(matrix)));
  const auto diagonal = normal.matrixLLT().diagonal();
  Eigen::VectorXd solution;
  if (normal.info() == Eigen::Success &&
      diagonal.minCoeff() > kWellConditioned * diagonal.maxCoeff()) {
    solution = normal.solve(matrix.transpose().lazyProduct(target));
  } else {
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
    decomposition.setThreshold(1e-9);
    solution = decomposition.compute(matrix).solve(target);
  }
  return {solution.begin(), solution.end()};
}

double value_at(const PatchBasis& basis, const std::vector<double>& coefficients,
                std::size_t cell) {
  double sum = 0;
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    sum += coefficients[k] * basis.values(k)[cell];
  }
  return sum;
}

double mean_error(const PatchBasis& basis, const std::vector<double>& coefficients,
                  std::span<const double> ranges, const std::vector<std::uint32_t>& cells) {
  double sum = 0;
  for (const std::uint32_t cell : cells) {
    sum += std::abs(value_at(basis, coefficients, cell) - ranges[cell]);
  }
  return cells.empty() ? 0 : sum / static_cast<double>(cells.size());
}

/// Sample cells by their use.
struct Samples {
  std::vector<std::uint32_t> training, testing, all;
  bool any_own = false;  ///< whether one lies in the patch itself

  Samples(std::span<const double> ranges, std::span<const CellRole> roles, bool hold_out) {
    for (std::uint32_t cell = 0; cell < ranges.size(); ++cell) {
      if (ranges[cell] <= 0) continue;
      any_own = any_own || roles[cell] != CellRole::extended;
      all.push_back(cell);
      (hold_out && roles[cell] == CellRole::testing ? testing : training).push_back(cell);
    }
    if (training.empty()) training = all;  // a patch of testing cells only
  }
};

/// Number of functions used at a degree for a number of samples: never more than there are samples.
/// A fit that is to be tested on held-out cells needs as many spare samples as it has freedoms.
std::size_t functions_for(PatchBasis& basis, std::size_t degree, std::size_t samples,
                          const FitSettings& settings) {
  basis.extend(degree);
  const std::size_t allowed = settings.stop_on_total_error ? (samples + 1) / 2 : samples;
  return std::min(basis.functions(std::min(degree, basis.degree())), allowed);
}

std::size_t choose_degree(PatchBasis& basis, std::span<const double> ranges, const Samples& samples,
                          const FitSettings& settings) {
  double previous_total = 0;
  std::size_t degree = 1;
  for (;; ++degree) {
    const std::size_t count = functions_for(basis, degree, samples.training.size(), settings);
    const std::vector<double> c = solve(basis, ranges, samples.training, count);
    const double training = mean_error(basis, c, ranges, samples.training);
    if (training <= settings.accept_m) break;
    const double testing = mean_error(basis, c, ranges, samples.testing);
    const double weight = training_weight(degree, settings.k);
    const double total = weight * training + (1 - weight) * testing;
    if (settings.stop_on_total_error && degree > 1 && total > previous_total) return degree - 1;
    previous_total = total;
    const std::size_t available = basis.functions(std::min(degree, basis.degree()));
    const bool exhausted = count < available || (basis.complete() && degree >= basis.degree());
    if (exhausted || degree >= settings.max_degree) break;
  }
  return degree;
}

}  // namespace

double training_weight(std::size_t degree, double k) {
  const double ratio = static_cast<double>(degree) / k;
  return 1 / (1 + ratio * ratio);
}

PatchFit fit_patch(PatchBasis& basis, std::span<const double> ranges,
                   std::span<const CellRole> roles, const FitSettings& settings) {
  const Samples samples(ranges, roles, settings.stop_on_total_error);
  if (!samples.any_own) return {};
  PatchFit fit;
  const std::size_t degree = choose_degree(basis, ranges, samples, settings);
  const std::size_t count = functions_for(basis, degree, samples.all.size(), settings);
  fit.degree = static_cast<std::uint32_t>(basis.degree_with(count));
  fit.coefficients = solve(basis, ranges, samples.all, count);
  for (double& c : fit.coefficients) c = static_cast<double>(static_cast<float>(c));
  return fit;
}

std::vector<double> fitted_ranges(const PatchBasis& basis, const PatchFit& fit) {
  std::vector<double> ranges(basis.cells());
  for (std::size_t cell = 0; cell < ranges.size(); ++cell) {
    ranges[cell] = value_at(basis, fit.coefficients, cell);
  }
  return ranges;
}

}  // namespace curlidar
