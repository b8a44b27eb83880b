// SPDX-License-Identifier: BSD-3-Clause
#include "field/spherical_harmonics.hpp"

#include <cmath>
#include <numbers>

namespace curlidar {

std::vector<double> legendre(std::size_t degree, double cos_theta, double sin_theta) {
  std::vector<double> p(legendre_index(degree + 1, 0));
  p[0] = std::sqrt(1 / (4 * std::numbers::pi));
  for (std::size_t m = 1; m <= degree; ++m) {
    const double order = static_cast<double>(m);
    const double ratio = m == 1 ? std::sqrt(3.0) : std::sqrt((2 * order + 1) / (2 * order));
    p[legendre_index(m, m)] = ratio * sin_theta * p[legendre_index(m - 1, m - 1)];
  }
  for (std::size_t m = 0; m < degree; ++m) {
    const double order = static_cast<double>(m);
    p[legendre_index(m + 1, m)] = std::sqrt(2 * order + 3) * cos_theta * p[legendre_index(m, m)];
    for (std::size_t l = m + 2; l <= degree; ++l) {
      const double n = static_cast<double>(l);
      const double a = std::sqrt((4 * n * n - 1) / (n * n - order * order));
      const double b = std::sqrt(((n - 1) * (n - 1) - order * order) / (4 * (n - 1) * (n - 1) - 1));
      p[legendre_index(l, m)] =
          a * (cos_theta * p[legendre_index(l - 1, m)] - b * p[legendre_index(l - 2, m)]);
    }
  }
  return p;
}

std::vector<double> real_harmonics(std::size_t degree, double theta, double phi) {
  const std::vector<double> p = legendre(degree, std::cos(theta), std::abs(std::sin(theta)));
  std::vector<double> y((degree + 1) * (degree + 1));
  for (std::size_t m = 0; m <= degree; ++m) {
    const double c = std::cos(static_cast<double>(m) * phi);
    const double s = std::sin(static_cast<double>(m) * phi);
    for (std::size_t l = m; l <= degree; ++l) {
      const std::size_t middle = l * l + l;
      y[middle + m] = p[legendre_index(l, m)] * c;
      if (m > 0) y[middle - m] = p[legendre_index(l, m)] * s;
    }
  }
  return y;
}

}  // namespace curlidar
