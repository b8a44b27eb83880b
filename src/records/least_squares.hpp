// SPDX-License-Identifier: BSD-3-Clause
// Linear prediction by weighted least squares that forget.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace curlidar::records {

/// Learns the coefficients of a linear function of `N` features. Additions, products, quotients and
/// square roots of doubles in a fixed order: the same on every machine.
template <std::size_t N>
class LeastSquares {
 public:
  using Features = std::array<double, N>;

  double predict(const Features& features) const {
    double sum = 0;
    for (std::size_t i = 0; i < N; ++i) sum += coefficients_[i] * features[i];
    return sum;
  }

  /// `keep` is what earlier lessons count for, below 1; the coefficients follow every fourth
  /// lesson.
  void learn(const Features& features, double value, double weight, double keep) {
    for (std::size_t i = 0; i < N; ++i) {
      const double weighted = weight * features[i];
      for (std::size_t j = 0; j <= i; ++j) {
        moments_[i][j] = moments_[i][j] * keep + weighted * features[j];
      }
      targets_[i] = targets_[i] * keep + weighted * value;
    }
    if (++lessons_ % 4 == 0) solve();
  }

 private:
  static constexpr double kRidge = 1e-3;

  /// Cholesky's method; leaves the coefficients as they are where it fails.
  void solve() {
    std::array<Features, N> lower{};
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = moments_[i][j];
        if (i == j) sum += kRidge;
        for (std::size_t k = 0; k < j; ++k) sum -= lower[i][k] * lower[j][k];
        if (i != j) {
          lower[i][j] = sum / lower[j][j];
        } else if (sum > 1e-9) {
          lower[i][i] = std::sqrt(sum);
        } else {
          return;
        }
      }
    }
    Features solution{};
    for (std::size_t i = 0; i < N; ++i) {
      double sum = targets_[i];
      for (std::size_t k = 0; k < i; ++k) sum -= lower[i][k] * solution[k];
      solution[i] = sum / lower[i][i];
    }
    for (std::size_t i = N; i-- > 0;) {
      double sum = solution[i];
      for (std::size_t k = i + 1; k < N; ++k) sum -= lower[k][i] * solution[k];
      solution[i] = sum / lower[i][i];
    }
    coefficients_ = solution;
  }

  std::array<Features, N> moments_{};
  Features targets_{}, coefficients_{};
  std::size_t lessons_ = 0;
};

}  // namespace curlidar::records
