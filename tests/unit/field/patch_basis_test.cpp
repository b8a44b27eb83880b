// SPDX-License-Identifier: BSD-3-Clause
#include "field/patch_basis.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <numbers>

#include "curlidar/vec3.hpp"
#include "field/spherical_harmonics.hpp"
#include "support/clouds.hpp"

namespace curlidar {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;

/// A grid of directions around (elevation, azimuth), as a patch sees them.
struct Patch {
  double centre_elevation = 0, centre_azimuth = 0;
  std::vector<double> elevations, azimuths;  ///< of each cell

  Patch(std::size_t rows, std::size_t columns, double row_step, double column_step,
        double elevation, double azimuth)
      : centre_elevation(elevation), centre_azimuth(azimuth) {
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t j = 0; j < columns; ++j) {
        elevations.push_back(
            elevation - (static_cast<double>(i) - 0.5 * static_cast<double>(rows - 1)) * row_step);
        azimuths.push_back(azimuth +
                           (static_cast<double>(j) - 0.5 * static_cast<double>(columns - 1)) *
                               column_step);
      }
    }
  }

  LocalDirection local(double elevation, double azimuth) const {
    return LocalFrame(centre_elevation)
        .local(AngleParts::of(elevation), AngleParts::of((azimuth - centre_azimuth) / 2));
  }
  PatchBasis basis() const {
    std::vector<LocalDirection> cells;
    for (std::size_t i = 0; i < elevations.size(); ++i) {
      cells.push_back(local(elevations[i], azimuths[i]));
    }
    return PatchBasis(std::move(cells));
  }
  Eigen::MatrixXd harmonics(std::size_t degree) const {
    Eigen::MatrixXd out(static_cast<Eigen::Index>(elevations.size()),
                        static_cast<Eigen::Index>(harmonics_up_to(degree)));
    for (std::size_t i = 0; i < elevations.size(); ++i) {
      const auto y = real_harmonics(degree, kPi / 2 - elevations[i], azimuths[i]);
      for (std::size_t k = 0; k < y.size(); ++k) {
        out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = y[k];
      }
    }
    return out;
  }
};

/// The paper's window of 12 x 12 upsampled cells on an HDL-64E.
Patch small_patch() {
  return {12, 12, 0.21 * kDegree, 0.176 * kDegree, -8 * kDegree, 2.0};
}
/// Wide enough for the harmonics themselves to be told apart in doubles.
Patch wide_patch() {
  return {12, 12, 8 * kDegree, 9 * kDegree, 10 * kDegree, -1.0};
}

Eigen::MatrixXd columns_of(const PatchBasis& basis, std::size_t count) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(basis.cells()), static_cast<Eigen::Index>(count));
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < basis.cells(); ++i) {
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = basis.values(k)[i];
    }
  }
  return out;
}

TEST(LocalFrame, AgreesWithPlainTrigonometry) {
  test::Random random(1);
  const auto angle = [&](double span) {
    return (static_cast<double>(random.next() >> 11) * 0x1p-53 - 0.5) * span;
  };
  for (int i = 0; i < 200; ++i) {
    const double centre = angle(3.0), elevation = angle(kPi), azimuth = angle(2 * kPi);
    const Vec3 c = direction_of(centre, 0), d = direction_of(elevation, azimuth);
    const Vec3 north = direction_of(centre + kPi / 2, 0);
    const LocalDirection l =
        LocalFrame(centre).local(AngleParts::of(elevation), AngleParts::of(azimuth / 2));
    EXPECT_NEAR(l.east, d.y, 1e-14);
    EXPECT_NEAR(l.north, dot(d, north), 1e-14);
    EXPECT_NEAR(l.down, 1 - dot(d, c), 1e-14);
    EXPECT_NEAR(l.east * l.east + l.north * l.north, 2 * l.down - l.down * l.down, 1e-14);
  }
}

TEST(LocalFrame, KeepsTheDigitsOfSmallAngles) {
  const double up = 3e-6, across = 4e-6, centre = -0.3;
  const LocalDirection l =
      LocalFrame(centre).local(AngleParts::of(centre + up), AngleParts::of(across / 2));
  // 1 - cos of the angle between: haversine formula.
  const double expected = 2 * std::pow(std::sin(up / 2), 2) + 2 * std::cos(centre) *
                                                                  std::cos(centre + up) *
                                                                  std::pow(std::sin(across / 2), 2);
  EXPECT_NEAR(l.down / expected, 1, 1e-9);
}

TEST(PatchBasis, ColumnsAreOrthonormal) {
  for (const Patch& patch : {small_patch(), wide_patch()}) {
    PatchBasis basis = patch.basis();
    basis.extend(8);
    const Eigen::MatrixXd q = columns_of(basis, basis.functions(8));
    const Eigen::MatrixXd gram = q.transpose() * q / static_cast<double>(basis.cells());
    EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(),
              1e-12);
  }
}

TEST(PatchBasis, SpansTheHarmonicsOfEachDegree) {
  for (const Patch& patch : {small_patch(), wide_patch()}) {
    PatchBasis basis = patch.basis();
    for (std::size_t degree = 0; degree <= 6; ++degree) {
      basis.extend(degree);
      const Eigen::MatrixXd q = columns_of(basis, basis.functions(degree));
      const Eigen::MatrixXd y = patch.harmonics(degree);
      const Eigen::MatrixXd rest = y - q * (q.transpose() * y) / static_cast<double>(basis.cells());
      for (Eigen::Index k = 0; k < y.cols(); ++k) {
        EXPECT_LE(rest.col(k).norm(), 1e-9 * y.col(k).norm()) << degree << " " << k;
      }
    }
  }
}

TEST(PatchBasis, HasTheRankOfTheHarmonics) {
  const Patch wide = wide_patch();
  PatchBasis basis = wide.basis();
  for (std::size_t degree = 0; degree <= 5; ++degree) {
    basis.extend(degree);
    EXPECT_EQ(basis.functions(degree), harmonics_up_to(degree));
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
    qr.setThreshold(1e-9);
    EXPECT_EQ(static_cast<std::size_t>(qr.compute(wide.harmonics(degree)).rank()),
              basis.functions(degree));
  }
  // On a patch of a few degrees the functions are still told apart, though harmonics are not.
  PatchBasis small = small_patch().basis();
  small.extend(3);
  EXPECT_EQ(small.functions(3), harmonics_up_to(3));
}

TEST(PatchBasis, LocalPolynomialsGiveTheSameValues) {
  test::Random random(2);
  const Patch patch = small_patch();
  PatchBasis basis = patch.basis();
  for (const std::size_t degree : {0u, 1u, 2u, 3u, 5u}) {
    basis.extend(degree);
    // Also with a share of a degree's functions only.
    for (const std::size_t count : {basis.functions(degree), (harmonics_up_to(degree) - degree)}) {
      std::vector<double> coefficients(count);
      for (double& c : coefficients) c = static_cast<double>(random.below(2001)) / 1000 - 1;
      const std::vector<double> local = basis.to_local(coefficients, degree);
      ASSERT_EQ(local.size(), harmonics_up_to(degree));
      for (std::size_t i = 0; i < basis.cells(); ++i) {
        double expected = 0;
        for (std::size_t k = 0; k < count; ++k) expected += coefficients[k] * basis.values(k)[i];
        EXPECT_NEAR(evaluate_local(local, patch.local(patch.elevations[i], patch.azimuths[i])),
                    expected, 1e-9)
            << degree;
      }
    }
  }
}

TEST(PatchBasis, IsAHarmonicBetweenTheCells) {
  const Patch patch = small_patch();
  PatchBasis basis = patch.basis();
  constexpr std::size_t kFitted = 4;
  basis.extend(kFitted);
  const Eigen::MatrixXd q = columns_of(basis, basis.functions(kFitted));
  const Eigen::MatrixXd y = patch.harmonics(kFitted);
  const Eigen::MatrixXd shares = q.transpose() * y / static_cast<double>(basis.cells());
  for (std::size_t k = 0; k < harmonics_up_to(kFitted); ++k) {
    const Eigen::VectorXd c = shares.col(static_cast<Eigen::Index>(k));
    const auto local = basis.to_local({c.data(), static_cast<std::size_t>(c.size())}, kFitted);
    for (const double shift : {-0.9, -0.31, 0.07, 0.5, 0.98}) {
      const double elevation = patch.centre_elevation + shift * 1.2 * kDegree;
      const double azimuth = patch.centre_azimuth - shift * 0.8 * kDegree;
      EXPECT_NEAR(evaluate_local(local, patch.local(elevation, azimuth)),
                  real_harmonics(kFitted, kPi / 2 - elevation, azimuth)[k], 1e-8)
          << k;
    }
  }
}

TEST(PatchBasis, EvaluatesDegreesBeyondTheStack) {
  constexpr std::size_t kHigh = 40;
  const LocalDirection d = LocalFrame(0.2).local(AngleParts::of(0.9), AngleParts::of(0.35));
  std::vector<double> a(harmonics_up_to(kHigh), 0.0);
  a[0] = 2;
  a[kHigh * kHigh] = 3;       // Re zeta^40
  a[kHigh * kHigh + 1] = -1;  // Im zeta^40
  a.back() = 0.5;             // down^40
  const double angle = std::atan2(d.north, d.east), radius = std::hypot(d.east, d.north);
  const double m = static_cast<double>(kHigh);
  const double expected = 2 +
                          std::pow(radius, m) * (3 * std::cos(m * angle) - std::sin(m * angle)) +
                          0.5 * std::pow(d.down, m);
  EXPECT_NEAR(evaluate_local(a, d), expected, 1e-12);
}

TEST(PatchBasis, NeverHasMoreFunctionsThanCells) {
  for (const auto& [rows, columns] :
       {std::pair<std::size_t, std::size_t>{1, 1}, {1, 7}, {7, 1}, {2, 2}, {3, 2}, {4, 4}}) {
    PatchBasis basis = Patch(rows, columns, 0.4 * kDegree, 0.35 * kDegree, -0.2, 0.5).basis();
    basis.extend(kMaxPatchDegree + 5);
    EXPECT_TRUE(basis.complete());
    EXPECT_LE(basis.degree(), kMaxPatchDegree);
    const std::size_t functions = basis.functions(basis.degree());
    EXPECT_LE(functions, rows * columns);
    EXPECT_GE(functions, 1u);
    if (rows * columns <= 4) {
      EXPECT_EQ(functions, rows * columns);
    }
    const Eigen::MatrixXd q = columns_of(basis, functions);
    const Eigen::MatrixXd gram = q.transpose() * q / static_cast<double>(basis.cells());
    EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(),
              1e-9);
  }
}

TEST(PatchBasis, OneCellHoldsAConstantOnly) {
  PatchBasis basis = Patch(1, 1, 0, 0, 0.1, 0.2).basis();
  EXPECT_EQ(basis.functions(0), 1u);
  EXPECT_TRUE(basis.complete());
  EXPECT_EQ(basis.degree_with(5), 0u);
  EXPECT_DOUBLE_EQ(basis.values(0)[0], 1);
  const std::vector<double> seven{7};
  EXPECT_EQ(basis.to_local(seven, 0), seven);
}

TEST(PatchBasis, KeepsItsBounds) {
  PatchBasis basis = Patch(20, 20, 2 * kDegree, 2 * kDegree, 0, 0).basis();
  basis.extend(1000);
  EXPECT_TRUE(basis.complete());
  EXPECT_LE(basis.functions(basis.degree()), kMaxPatchFunctions);
  EXPECT_LE(basis.degree(), kMaxPatchDegree);
}

TEST(PatchBasis, FindsTheLowestDegreeWithEnoughFunctions) {
  PatchBasis basis = small_patch().basis();
  EXPECT_EQ(basis.degree_with(1), 0u);
  EXPECT_EQ(basis.degree_with(2), 1u);
  EXPECT_EQ(basis.degree_with(4), 1u);
  EXPECT_EQ(basis.degree_with(5), 2u);
  EXPECT_EQ(basis.degree_with(10), 3u);
  EXPECT_EQ(basis.degree_with(3), 1u);
  // No degree has that many: the highest there is.
  const std::size_t highest = basis.degree_with(100000);
  EXPECT_TRUE(basis.complete());
  EXPECT_EQ(highest, basis.degree());
}

TEST(PatchBasis, DoesNotDependOnHowItWasExtended) {
  PatchBasis at_once = small_patch().basis(), by_steps = small_patch().basis();
  at_once.extend(5);
  for (std::size_t degree = 1; degree <= 5; ++degree) by_steps.extend(degree);
  ASSERT_EQ(at_once.functions(5), by_steps.functions(5));
  for (std::size_t k = 0; k < at_once.functions(5); ++k) {
    EXPECT_EQ(at_once.values(k), by_steps.values(k));
  }
}

}  // namespace
}  // namespace curlidar
