// SPDX-License-Identifier: BSD-3-Clause
// Real spherical harmonics on the whole sphere (paper, Eq. 4, in their real form).
#pragma once

#include <cstddef>
#include <vector>

namespace curlidar {

/// Index of order m (0 <= m <= l) of degree l in a triangle of Legendre values.
constexpr std::size_t legendre_index(std::size_t l, std::size_t m) {
  return l * (l + 1) / 2 + m;
}

/// Fully normalised associated Legendre functions without Condon-Shortley phase, for all l up to
/// `degree`: sqrt((2l+1)/(4 pi) (l-m)!/(l+m)!) P_l^m(cos_theta), times sqrt(2) for m > 0.
/// Recurrences over l from the sectoral terms (Holmes and Featherstone 2002): no factorials, stable
/// to degrees in the hundreds. sin_theta must be the non-negative partner of cos_theta.
std::vector<double> legendre(std::size_t degree, double cos_theta, double sin_theta);

/// All real harmonics up to `degree` at inclination theta from +z and azimuth phi: index
/// l^2 + l + m holds cos(m phi) terms for m >= 0 and sin(|m| phi) terms for m < 0. They are
/// orthonormal on the unit sphere. O(degree^2).
std::vector<double> real_harmonics(std::size_t degree, double theta, double phi);

}  // namespace curlidar
