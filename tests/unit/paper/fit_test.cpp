// SPDX-License-Identifier: BSD-3-Clause
#include "paper/fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "unit/paper/images.hpp"

namespace curlidar {
namespace {

using test::unit;

/// The paper's window: 8 x 8 cells of its own and two more on every side.
struct Window {
  PatchGrid grid{Lattice::uniform(64, 1024, 2 * test::kDegree, -24.9 * test::kDegree), 2, 2, 4, 2};
  PatchBasis basis = grid.make_basis(5, 9);
  std::vector<CellRole> roles = grid.roles(5, 9);
  std::vector<double> ranges = std::vector<double>(roles.size(), 0.0);

  /// 10 plus `scale` times a function of the basis.
  void set_function(std::size_t k, double scale) {
    basis.degree_with(k + 1);
    for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i] = 10 + scale * basis.values(k)[i];
  }
  double largest_error(const PatchFit& fit) const {
    const std::vector<double> fitted = fitted_ranges(basis, fit);
    double worst = 0;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      if (ranges[i] > 0) worst = std::max(worst, std::abs(fitted[i] - ranges[i]));
    }
    return worst;
  }
  PatchFit fit(const FitSettings& settings) { return fit_patch(basis, ranges, roles, settings); }
};

constexpr FitSettings kTight{100, 1e-4, 9, false};

TEST(TrainingWeight, IsCauchys) {
  EXPECT_DOUBLE_EQ(training_weight(9, 9), 0.5);
  EXPECT_DOUBLE_EQ(training_weight(0, 9), 1);
  EXPECT_DOUBLE_EQ(training_weight(18, 9), 0.2);
  EXPECT_DOUBLE_EQ(training_weight(1, 9), 81.0 / 82);
  EXPECT_DOUBLE_EQ(training_weight(5, 5), 0.5);
}

TEST(FitPatch, AConstantNeedsTheFirstDegreeOnly) {
  Window w;
  w.ranges.assign(w.ranges.size(), 12.5);
  const PatchFit fit = w.fit({100, 1e-6, 9, true});
  EXPECT_EQ(fit.degree, 1u);
  ASSERT_EQ(fit.coefficients.size(), 4u);
  EXPECT_DOUBLE_EQ(fit.coefficients[0], 12.5);
  for (std::size_t k = 1; k < 4; ++k) EXPECT_NEAR(fit.coefficients[k], 0, 1e-10);
  EXPECT_LT(w.largest_error(fit), 1e-9);
}

TEST(FitPatch, FindsTheDegreeOfAFunction) {
  for (std::uint32_t degree = 1; degree <= 4; ++degree) {
    Window w;
    w.set_function(harmonics_up_to(degree) - 1, 0.8);
    const PatchFit fit = w.fit(kTight);
    EXPECT_EQ(fit.degree, degree);
    ASSERT_EQ(fit.coefficients.size(), harmonics_up_to(degree));
    EXPECT_NEAR(fit.coefficients.front(), 10, 1e-6);
    EXPECT_NEAR(fit.coefficients.back(), 0.8, 1e-6);
    EXPECT_LT(w.largest_error(fit), 1e-5);
  }
}

TEST(FitPatch, AcceptsTheFirstDegreeThatIsGoodEnough) {
  Window w;
  w.set_function(harmonics_up_to(3) - 1, 0.8);
  EXPECT_EQ(w.fit({100, 5, 9, false}).degree, 1u);
  EXPECT_EQ(w.fit({2, 1e-4, 9, false}).degree, 2u);  // as far as max_degree allows
}

TEST(FitPatch, FitsAPlaneClosely) {
  Window w;
  const Vec3 normal{0.1, 0.05, 1};
  const CellRect window = w.grid.window(5, 9);
  const Lattice lattice = Lattice::uniform(64, 1024, 2 * test::kDegree, -24.9 * test::kDegree);
  std::size_t cell = 0;
  for (std::int64_t i = window.row_begin; i < window.row_end; ++i) {
    for (std::int64_t j = window.column_begin; j < window.column_end; ++j) {
      w.ranges[cell++] = -1.7 / dot(lattice.direction((static_cast<double>(i) - 1) / 2,
                                                      static_cast<double>(j) / 2),
                                    normal);
    }
  }
  const PatchFit paper = w.fit({100, 0.5, 9, true});
  EXPECT_EQ(paper.degree, 1u);
  EXPECT_LT(w.largest_error(paper), 0.3);
  const PatchFit tight = w.fit({100, 0.005, 9, true});
  EXPECT_GT(tight.degree, 1u);
  EXPECT_LT(w.largest_error(tight), 0.03);
}

TEST(FitPatch, StopsWhenTheTotalErrorRises) {
  // Held-out cells that no degree can foresee: their growing weight raises the total at once.
  Window w;
  test::Random random(41);
  for (std::size_t i = 0; i < w.ranges.size(); ++i) {
    w.ranges[i] = w.roles[i] == CellRole::testing ? 16 : 10 + 0.2 * unit(random);
  }
  EXPECT_EQ(w.fit({100, 1e-3, 9, true}).degree, 1u);
  // Where testing never gets a weight, the training error alone drives the degree up.
  EXPECT_GT(w.fit({100, 1e-3, 1e6, true}).degree, 3u);
  // Without the stop there is no end before the samples run out.
  EXPECT_EQ(w.fit({100, 1e-9, 9, false}).coefficients.size(), w.ranges.size());
}

/// The paper's choice of degree in plain words, by singular values.
std::uint32_t expected_degree(Window& w, const FitSettings& s) {
  std::vector<std::size_t> training, testing;
  for (std::size_t i = 0; i < w.ranges.size(); ++i) {
    if (w.ranges[i] > 0) (w.roles[i] == CellRole::testing ? testing : training).push_back(i);
  }
  double previous = 0;
  for (std::uint32_t degree = 1;; ++degree) {
    w.basis.extend(degree);
    const std::size_t count = std::min(w.basis.functions(degree), (training.size() + 1) / 2);
    const auto matrix = [&](const std::vector<std::size_t>& cells) {
      Eigen::MatrixXd m(static_cast<Eigen::Index>(cells.size()), static_cast<Eigen::Index>(count));
      for (std::size_t i = 0; i < cells.size(); ++i) {
        for (std::size_t k = 0; k < count; ++k) {
          m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
              w.basis.values(k)[cells[i]];
        }
      }
      return m;
    };
    const auto target = [&](const std::vector<std::size_t>& cells) {
      Eigen::VectorXd v(static_cast<Eigen::Index>(cells.size()));
      for (std::size_t i = 0; i < cells.size(); ++i) {
        v[static_cast<Eigen::Index>(i)] = w.ranges[cells[i]];
      }
      return v;
    };
    const Eigen::VectorXd c = Eigen::JacobiSVD<Eigen::MatrixXd>(
                                  matrix(training), Eigen::ComputeThinU | Eigen::ComputeThinV)
                                  .solve(target(training));
    const double e_train = (matrix(training) * c - target(training)).cwiseAbs().mean();
    if (e_train <= s.accept_m) return degree;
    const double e_test = (matrix(testing) * c - target(testing)).cwiseAbs().mean();
    const double weight = 1 / (1 + std::pow(degree / s.k, 2));
    const double total = weight * e_train + (1 - weight) * e_test;
    if (degree > 1 && total > previous) return degree - 1;
    previous = total;
    if (count < w.basis.functions(degree)) return degree;
  }
}

TEST(FitPatch, ChoosesTheDegreeOfThePaper) {
  test::Random random(42);
  std::vector<int> chosen(20, 0);
  for (int round = 0; round < 30; ++round) {
    Window w;
    const auto smooth = static_cast<std::size_t>(random.below(30));
    w.set_function(smooth, 2);
    const double noise = unit(random), share = 0.3 + 0.7 * unit(random);
    for (double& r : w.ranges) r = unit(random) < share ? r + noise * (unit(random) - 0.5) : 0;
    const FitSettings settings{100, 0.02, 9, true};
    const std::uint32_t expected = expected_degree(w, settings);
    EXPECT_EQ(w.fit(settings).degree, expected) << round;
    ++chosen[expected];
  }
  // The rounds are of use only if they differ.
  EXPECT_GE(std::count_if(chosen.begin(), chosen.end(), [](int n) { return n > 0; }), 4);
}

TEST(FitPatch, RefitsOnAllSamples) {
  // Noise on held-out cells: the final coefficients are the least squares over all of them.
  Window w;
  test::Random random(43);
  for (double& r : w.ranges) r = 10 + unit(random);
  const PatchFit fit = w.fit({100, 5, 9, true});
  ASSERT_EQ(fit.coefficients.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {  // the basis is orthonormal over the full window
    double mean = 0;
    for (std::size_t i = 0; i < w.ranges.size(); ++i) {
      mean += w.ranges[i] * w.basis.values(k)[i] / static_cast<double>(w.ranges.size());
    }
    EXPECT_NEAR(fit.coefficients[k], mean, 1e-6);
    EXPECT_EQ(fit.coefficients[k], static_cast<double>(static_cast<float>(fit.coefficients[k])));
  }
}

TEST(FitPatch, NeverHasMoreCoefficientsThanSamples) {
  test::Random random(44);
  for (int round = 0; round < 40; ++round) {
    Window w;
    const double share = 0.01 + 0.2 * unit(random);
    std::size_t samples = 0, own = 0;
    for (std::size_t i = 0; i < w.ranges.size(); ++i) {
      if (unit(random) >= share) continue;
      w.ranges[i] = 5 + 15 * unit(random);
      ++samples;
      own += w.roles[i] != CellRole::extended;
    }
    const PatchFit strict = w.fit({100, 0, 9, true});
    const PatchFit tuned = w.fit({100, 0, 9, false});
    if (own == 0) {
      EXPECT_TRUE(strict.coefficients.empty());
      EXPECT_TRUE(tuned.coefficients.empty());
      continue;
    }
    EXPECT_LE(strict.coefficients.size(), (samples + 1) / 2);
    EXPECT_LE(tuned.coefficients.size(), samples);
    EXPECT_EQ(tuned.degree, w.basis.degree_with(tuned.coefficients.size()));
    for (const double c : tuned.coefficients) EXPECT_TRUE(std::isfinite(c));
  }
}

TEST(FitPatch, WithoutOwnSamplesStaysEmpty) {
  Window w;
  EXPECT_TRUE(w.fit(kTight).coefficients.empty());
  for (std::size_t i = 0; i < w.ranges.size(); ++i) {
    if (w.roles[i] == CellRole::extended) w.ranges[i] = 10;
  }
  const PatchFit fit = w.fit(kTight);
  EXPECT_TRUE(fit.coefficients.empty());
  const std::vector<double> fitted = fitted_ranges(w.basis, fit);
  EXPECT_EQ(std::count(fitted.begin(), fitted.end(), 0.0),
            static_cast<std::ptrdiff_t>(fitted.size()));
}

TEST(FitPatch, OneSampleIsAConstant) {
  for (const CellRole role : {CellRole::training, CellRole::testing}) {
    for (const bool stop : {true, false}) {
      Window w;
      const auto cell = static_cast<std::size_t>(std::find(w.roles.begin(), w.roles.end(), role) -
                                                 w.roles.begin());
      w.ranges[cell] = 7.25;
      const PatchFit fit = w.fit({100, 1e-3, 9, stop});
      EXPECT_EQ(fit.degree, 0u);
      ASSERT_EQ(fit.coefficients.size(), 1u);
      EXPECT_DOUBLE_EQ(fit.coefficients[0], 7.25);
    }
  }
}

TEST(FitPatch, SamplesInOneRowOrColumnStayTame) {
  for (const bool along_row : {true, false}) {
    Window w;
    for (std::size_t i = 0; i < 12; ++i) {
      w.ranges[along_row ? 5 * 12 + i : i * 12 + 5] = 10 + 0.1 * static_cast<double>(i);
    }
    const PatchFit fit = w.fit({100, 1e-3, 9, false});
    EXPECT_LT(w.largest_error(fit), 0.01);
    for (const double c : fit.coefficients) EXPECT_LT(std::abs(c), 20);  // of minimum norm
  }
}

TEST(FitPatch, APatchOfOneCell) {
  const PatchGrid grid(Lattice::uniform(3, 8, 0.1, -0.1), 1, 1, 1, 0);
  PatchBasis basis = grid.make_basis(1, 1);
  const std::vector<double> ranges{9};
  const PatchFit fit = fit_patch(basis, ranges, grid.roles(1, 1), {100, 0.5, 9, true});
  EXPECT_EQ(fit.degree, 0u);
  EXPECT_EQ(fit.coefficients, ranges);
}

}  // namespace
}  // namespace curlidar
