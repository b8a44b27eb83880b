// SPDX-License-Identifier: BSD-3-Clause
#include "field/spherical_harmonics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/legendre.hpp>
#include <boost/math/special_functions/spherical_harmonic.hpp>
#include <cmath>
#include <numbers>

#include "curlidar/vec3.hpp"

namespace curlidar {
namespace {

constexpr double kPi = std::numbers::pi;

struct Direction {
  double theta, phi;
};

const std::vector<Direction> kDirections{
    {0.3, 0.1}, {1.2, -2.9}, {kPi / 2, 3.1}, {2.8, 1.7},   {1e-9, 0.4},       {kPi - 1e-7, -1.2},
    {0.0, 0.0}, {kPi, 2.2},  {1e-3, -0.7},   {kPi / 3, 0}, {kPi - 0.02, -kPi}};

/// Real form of Boost's complex harmonics, whose Condon-Shortley phase is taken out.
double boost_real(unsigned l, int m, const Direction& d) {
  const int order = std::abs(m);
  const double phase = order % 2 == 0 ? 1 : -1;
  if (m == 0) return boost::math::spherical_harmonic_r(l, 0, d.theta, d.phi);
  const double part = m > 0 ? boost::math::spherical_harmonic_r(l, order, d.theta, d.phi)
                            : boost::math::spherical_harmonic_i(l, order, d.theta, d.phi);
  return std::numbers::sqrt2 * phase * part;
}

TEST(RealHarmonics, AgreeWithBoost) {
  constexpr std::size_t kDegree = 20;
  for (const Direction& d : kDirections) {
    const std::vector<double> y = real_harmonics(kDegree, d.theta, d.phi);
    ASSERT_EQ(y.size(), (kDegree + 1) * (kDegree + 1));
    for (int l = 0; l <= static_cast<int>(kDegree); ++l) {
      for (int m = -l; m <= l; ++m) {
        EXPECT_NEAR(y[static_cast<std::size_t>(l * l + l + m)],
                    boost_real(static_cast<unsigned>(l), m, d), 2e-12)
            << "l " << l << " m " << m << " theta " << d.theta;
      }
    }
  }
}

TEST(RealHarmonics, FirstDegreesAreTheKnownFormulas) {
  const Direction d{0.8, 2.1};
  const Vec3 v = direction_of(kPi / 2 - d.theta, d.phi);
  const std::vector<double> y = real_harmonics(2, d.theta, d.phi);
  const double c1 = std::sqrt(3 / (4 * kPi)), c2 = std::sqrt(15 / (4 * kPi));
  EXPECT_NEAR(y[0], std::sqrt(1 / (4 * kPi)), 1e-15);
  EXPECT_NEAR(y[1], c1 * v.y, 1e-15);
  EXPECT_NEAR(y[2], c1 * v.z, 1e-15);
  EXPECT_NEAR(y[3], c1 * v.x, 1e-15);
  EXPECT_NEAR(y[4], c2 * v.x * v.y, 1e-15);
  EXPECT_NEAR(y[5], c2 * v.y * v.z, 1e-15);
  EXPECT_NEAR(y[6], std::sqrt(5 / (16 * kPi)) * (3 * v.z * v.z - 1), 1e-15);
  EXPECT_NEAR(y[7], c2 * v.x * v.z, 1e-15);
  EXPECT_NEAR(y[8], c2 / 2 * (v.x * v.x - v.y * v.y), 1e-15);
}

TEST(RealHarmonics, AdditionTheoremHoldsToDegree100) {
  constexpr std::size_t kDegree = 100;
  for (const Direction& a : kDirections) {
    const std::vector<double> ya = real_harmonics(kDegree, a.theta, a.phi);
    for (const Direction& b : kDirections) {
      const std::vector<double> yb = real_harmonics(kDegree, b.theta, b.phi);
      const double cos_gamma = std::clamp(
          dot(direction_of(kPi / 2 - a.theta, a.phi), direction_of(kPi / 2 - b.theta, b.phi)), -1.0,
          1.0);
      for (std::size_t l = 0; l <= kDegree; ++l) {
        double sum = 0;
        for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i) sum += ya[i] * yb[i];
        const double scale = static_cast<double>(2 * l + 1) / (4 * kPi);
        // P_l is as steep as l^2 / 2 at the poles of its argument, whose rounding it amplifies.
        EXPECT_NEAR(sum / scale, std::legendre(static_cast<unsigned>(l), cos_gamma), 5e-12)
            << "l " << l << " theta " << a.theta << " and " << b.theta;
      }
    }
  }
}

TEST(RealHarmonics, AreOrthonormalOnTheSphere) {
  constexpr int kDegree = 10, kNodes = 12, kAzimuths = 24;  // exact for products up to degree 20
  constexpr std::size_t kCount = (kDegree + 1) * (kDegree + 1);
  std::vector<double> gram(kCount * kCount, 0.0);
  for (const double zero : boost::math::legendre_p_zeros<double>(kNodes)) {
    const double slope = boost::math::legendre_p_prime(kNodes, zero);
    const double weight = 2 / ((1 - zero * zero) * slope * slope) * 2 * kPi / kAzimuths;
    for (const double x : {zero, -zero}) {
      for (int j = 0; j < kAzimuths; ++j) {
        const auto y = real_harmonics(kDegree, std::acos(x), 2 * kPi * j / kAzimuths);
        for (std::size_t p = 0; p < kCount; ++p) {
          for (std::size_t q = 0; q <= p; ++q) gram[p * kCount + q] += weight * y[p] * y[q];
        }
      }
    }
  }
  for (std::size_t p = 0; p < kCount; ++p) {
    for (std::size_t q = 0; q <= p; ++q) {
      EXPECT_NEAR(gram[p * kCount + q], p == q ? 1 : 0, 1e-12) << p << " " << q;
    }
  }
}

TEST(Legendre, StaysFiniteAtHighDegrees) {
  for (const double theta : {0.0, 1e-6, 0.5, kPi / 2, 3.0, kPi}) {
    const auto p = legendre(300, std::cos(theta), std::abs(std::sin(theta)));
    ASSERT_EQ(p.size(), legendre_index(301, 0));
    for (const double v : p) ASSERT_TRUE(std::isfinite(v)) << theta;
    // On the axis only the zonal functions live.
    if (theta == 0.0) {
      EXPECT_NEAR(p[legendre_index(300, 0)], std::sqrt(601 / (4 * kPi)), 1e-10);
      EXPECT_EQ(p[legendre_index(300, 7)], 0);
    }
  }
}

}  // namespace
}  // namespace curlidar
