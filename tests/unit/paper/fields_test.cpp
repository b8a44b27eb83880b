// SPDX-License-Identifier: BSD-3-Clause
// From samples to fields: both passes of the fit, PatchField and GlobalField.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "field/spherical_harmonics.hpp"
#include "paper/global_fit.hpp"
#include "paper/patch_field.hpp"
#include "paper/pipeline.hpp"
#include "unit/paper/images.hpp"

namespace curlidar {
namespace {

using test::make_image;
using test::small_lattice;

PaperSettings small_settings(std::uint32_t factor) {
  PaperSettings s;
  s.upsample_rows = s.upsample_columns = factor;
  s.min_range_m = 1;
  s.accept_m = 0.01;
  s.refused_triangle_share = 0;
  s.cliffs = {1e6, 1e6, 1e6};
  return s;
}

PaperStages stages_of(const RangeImage& image, const PaperSettings& s) {
  PaperStages stages;
  stages.image = image;
  stages.mesh = make_polar_mesh(image);
  stages.masks = make_masks(image, s.cliffs);
  stages.samples = upsample(image, stages.mesh, stages.masks, s.upsample_rows, s.upsample_columns,
                            s.refused_triangle_share, 1);
  return stages;
}

/// A smooth room: no two directions far apart in range.
RangeImage room(const Lattice& lattice) {
  return make_image(lattice, [&](std::size_t row, std::size_t column) {
    const double azimuth = lattice.azimuth(static_cast<double>(column));
    return 12 + 2 * std::cos(azimuth - 1) + std::sin(2 * azimuth) + 0.1 * static_cast<double>(row);
  });
}

std::vector<double> evaluated(const Field& field, double row, const std::vector<double>& columns,
                              bool masked = false) {
  std::vector<double> ranges(columns.size());
  field.evaluate_row(row, columns, masked, ranges);
  return ranges;
}

TEST(FitPatches, ASampleThatStandsOutIsRemovedAndTheRestFittedAgain) {
  const RangeImage image = make_image(
      small_lattice(16, 64),
      [](std::size_t row, std::size_t column) { return row == 6 && column == 21 ? 12.0 : 10.0; });
  PaperSettings settings = small_settings(1);
  settings.accept_m = 0.5;
  const PaperModel model = fit_patches(stages_of(image, settings), settings, 1, {});
  EXPECT_EQ(model.settings.max_range.metres, 12);
  EXPECT_EQ(std::count(model.masks.point.begin(), model.masks.point.end(), 0), 1);
  EXPECT_EQ(model.masks.point[model.masks.index(6, 21)], 0);
  ASSERT_EQ(model.patches.size(), 4u * 16u);
  for (const PatchFit& fit : model.patches) {  // nothing of it is left in any patch
    ASSERT_FALSE(fit.coefficients.empty());
    EXPECT_NEAR(fit.coefficients[0], 10, 1e-6);
  }
}

TEST(FitPatches, ARejectedSampleBetweenCellsSetsItsCliff) {
  const RangeImage image =
      make_image(small_lattice(16, 64), [](std::size_t, std::size_t) { return 10.0; });
  PaperSettings settings = small_settings(2);
  settings.accept_m = 0.5;
  PaperStages stages = stages_of(image, settings);
  stages.samples.range[stages.samples.index(12, 42)] = 12;  // half a row above row 6, column 21
  stages.samples.range[stages.samples.index(13, 61)] = 12;  // row 6, half a column behind 30
  stages.samples.range[stages.samples.index(20, 81)] = 12;  // both
  const PaperModel model = fit_patches(stages, settings, 1, {});
  const auto only = [&](const std::vector<std::uint8_t>& mask, std::size_t cell) {
    return mask[cell] == 1 && std::count(mask.begin(), mask.end(), 1) == 1;
  };
  EXPECT_TRUE(only(model.masks.cliff_row, model.masks.index(6, 21)));
  EXPECT_TRUE(only(model.masks.cliff_column, model.masks.index(6, 31)));
  EXPECT_TRUE(only(model.masks.cliff_diagonal, model.masks.index(10, 41)));
  EXPECT_EQ(std::count(model.masks.point.begin(), model.masks.point.end(), 0), 0);
}

TEST(FitPatches, CellsOfAPatchThatLostAllSamplesLoseTheirReturn) {
  // One patch of two cells whose ranges no accepted degree explains, nearer than reject_m.
  PaperSettings settings = small_settings(1);
  settings.min_range_m = 0;
  settings.patch = 1;
  settings.overlap = 1;
  settings.reject_m = 0.5;
  settings.accept_m = 100;
  const RangeImage image =
      make_image(small_lattice(9, 32), [](std::size_t row, std::size_t column) {
        if (row % 3 != 1) return 0.0;
        return column % 4 == 1 ? 0.3 : column % 4 == 2 ? 3.0 : 0.0;
      });
  const PaperModel model = fit_patches(stages_of(image, settings), settings, 1, {});
  const PatchField field(model);
  for (std::uint32_t row = 0; row < 9; ++row) {
    for (std::uint32_t column = 0; column < 32; ++column) {
      if (!field.occupied(row, column)) continue;
      EXPECT_TRUE(std::isfinite(evaluated(field, row, {static_cast<double>(column)}, true)[0]))
          << row << " " << column;
    }
  }
}

TEST(FitPatches, SameForAnyNumberOfThreads) {
  test::Random random(61);
  PaperSettings settings = small_settings(2);
  const PaperStages stages =
      stages_of(test::random_image(small_lattice(18, 50), 0.8, random), settings);
  const PaperModel one = fit_patches(stages, settings, 1, {});
  const PaperModel four = fit_patches(stages, settings, 4, {});
  ASSERT_EQ(one.patches.size(), four.patches.size());
  for (std::size_t i = 0; i < one.patches.size(); ++i) {
    EXPECT_EQ(one.patches[i].coefficients, four.patches[i].coefficients);
    EXPECT_EQ(one.patches[i].degree, four.patches[i].degree);
  }
  EXPECT_EQ(one.masks.point, four.masks.point);
  EXPECT_EQ(one.masks.cliff_diagonal, four.masks.cliff_diagonal);
}

TEST(PatchField, GivesTheFittedRangesAtTheCells) {
  for (const std::uint32_t factor : {1u, 2u}) {
    const PaperSettings settings = small_settings(factor);
    const Lattice lattice = small_lattice(18, 50);  // sizes that the patch size does not divide
    const PaperModel model = fit_patches(stages_of(room(lattice), settings), settings, 1, {});
    const PatchField field(model);
    const PatchGrid grid(lattice, factor, factor, settings.patch, settings.overlap);
    for (std::size_t patch = 0; patch < grid.count(); ++patch) {
      const std::size_t patch_row = patch / grid.columns(), patch_column = patch % grid.columns();
      PatchBasis basis = grid.make_basis(patch_row, patch_column);
      basis.extend(model.patches[patch].degree);
      const std::vector<double> fitted = fitted_ranges(basis, model.patches[patch]);
      const CellRect own = grid.core(patch_row, patch_column),
                     all = grid.window(patch_row, patch_column);
      for (std::int64_t i = own.row_begin; i < own.row_end; ++i) {
        for (std::int64_t j = own.column_begin; j < own.column_end; ++j) {
          const double row = static_cast<double>(i - (factor - 1)) / factor;
          const double column = static_cast<double>(j) / factor;
          const std::size_t cell = static_cast<std::size_t>(i - all.row_begin) * all.width() +
                                   static_cast<std::size_t>(j - all.column_begin);
          ASSERT_NEAR(evaluated(field, row, {column})[0], fitted[cell], 1e-7)
              << row << " " << column;
        }
      }
    }
  }
}

TEST(PatchField, IsContinuousInAzimuthAcrossTheSeam) {
  const PaperSettings settings = small_settings(2);
  const Lattice lattice = small_lattice(16, 64);
  const PatchField field(fit_patches(stages_of(room(lattice), settings), settings, 1, {}));
  for (const double row : {0.0, 3.3, 8.5, 15.0}) {
    // Column 0 is azimuth -pi, column 64 is +pi.
    const auto r = evaluated(field, row, {-1e-7, 0, 1e-7, 64 - 1e-7, 64, 64 + 1e-7, -64, 640});
    for (const double range : r) {
      ASSERT_TRUE(std::isfinite(range));
      EXPECT_NEAR(range, r[1], 1e-6);
    }
    EXPECT_NEAR(r[0], r[3], 1e-11);
    EXPECT_NEAR(r[2], r[5], 1e-11);
  }
}

TEST(PatchField, IsContinuousInsidePatches) {
  test::Random random(62);
  const PaperSettings settings = small_settings(2);
  const Lattice lattice = small_lattice(16, 64);
  const PatchField field(fit_patches(stages_of(room(lattice), settings), settings, 1, {}));
  const PatchGrid grid(lattice, 2, 2, settings.patch, settings.overlap);
  constexpr double kStep = 1e-6;
  int compared = 0;
  for (int i = 0; i < 500; ++i) {
    const double row = 15 * test::unit(random), column = 64 * test::unit(random);
    if (grid.patch_row_at(row) != grid.patch_row_at(row + kStep) ||
        grid.patch_column_at(column) != grid.patch_column_at(column + kStep)) {
      continue;
    }
    ++compared;
    const double here = evaluated(field, row, {column})[0];
    ASSERT_TRUE(std::isfinite(here));
    EXPECT_NEAR(evaluated(field, row, {column + kStep})[0], here, 1e-4);
    EXPECT_NEAR(evaluated(field, row + kStep, {column})[0], here, 1e-4);
  }
  EXPECT_GT(compared, 450);
}

TEST(PatchField, MasksAndLimitsLeaveNothing) {
  PaperSettings settings = small_settings(1);
  const RangeImage image = room(small_lattice(16, 64));
  PaperModel model = fit_patches(stages_of(image, settings), settings, 1, {});
  model.masks.point[model.masks.index(4, 7)] = 0;
  model.patches[0].coefficients.clear();
  model.patches[1].coefficients = {500};
  model.patches[2].coefficients = {-10};
  const PatchField field(model);
  EXPECT_FALSE(field.occupied(4, 7));
  EXPECT_TRUE(field.occupied(4, 8));
  EXPECT_TRUE(std::isnan(evaluated(field, 4, {7}, true)[0]));
  EXPECT_FALSE(std::isnan(evaluated(field, 4, {7}, false)[0]));
  EXPECT_TRUE(std::isnan(evaluated(field, -0.5, {20}, true)[0]));
  for (const double column : {1.0, 5.0, 9.0}) {  // empty, too far, behind the sensor
    EXPECT_TRUE(std::isnan(evaluated(field, 1, {column})[0])) << column;
  }
  EXPECT_FALSE(std::isnan(evaluated(field, 1, {13})[0]));
}

TEST(PatchField, CopesWithDegenerateScans) {
  const auto field_of = [](const Lattice& lattice, auto range_of) {
    const PaperSettings settings = small_settings(2);
    return PatchField(
        fit_patches(stages_of(make_image(lattice, range_of), settings), settings, 1, {}));
  };
  const auto empty = field_of(small_lattice(4, 8), [](std::size_t, std::size_t) { return 0.0; });
  EXPECT_TRUE(std::isnan(evaluated(empty, 1, {3})[0]));
  const auto ring = field_of(small_lattice(1, 16), [](std::size_t, std::size_t) { return 9.0; });
  EXPECT_NEAR(evaluated(ring, 0, {3.5}, true)[0], 9, 0.5);
  const auto single = field_of(small_lattice(8, 16), [](std::size_t row, std::size_t column) {
    return row == 3 && column == 5 ? 8.0 : 0.0;
  });
  EXPECT_NEAR(evaluated(single, 3, {5}, true)[0], 8, 1e-6);
  EXPECT_TRUE(std::isnan(evaluated(single, 3, {6}, true)[0]));
}

GlobalModel global_model(const Lattice& lattice, std::vector<double> coefficients) {
  PaperSettings settings;
  settings.min_range_m = 0;
  settings.max_range = {1e6, 0};
  CellMasks masks(lattice.rows(), lattice.columns());
  masks.point.assign(masks.point.size(), 1);
  return {lattice, settings, masks, std::move(coefficients)};
}

TEST(GlobalField, IsTheSumOfTheHarmonics) {
  test::Random random(63);
  constexpr std::size_t kDegree = 9;
  std::vector<double> coefficients((kDegree + 1) * (kDegree + 1));
  for (double& c : coefficients) c = test::unit(random) - 0.5;
  coefficients[0] = 200;
  const Lattice lattice = Lattice::uniform(20, 40, 1.5, -1.5);
  const GlobalField field(global_model(lattice, coefficients));
  for (const double row : {0.0, 4.25, 11.5, 19.0}) {
    const std::vector<double> columns{0, 0.3, 17.5, 39.9, 40, -12};
    const std::vector<double> ranges = evaluated(field, row, columns);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto y = real_harmonics(kDegree, std::numbers::pi / 2 - lattice.elevation(row),
                                    lattice.azimuth(columns[i]));
      double expected = 0;
      for (std::size_t k = 0; k < y.size(); ++k) expected += coefficients[k] * y[k];
      EXPECT_NEAR(ranges[i], expected, 1e-10);
    }
  }
}

TEST(FitGlobal, RecoversHarmonicsOnTheWholeSphere) {
  test::Random random(64);
  constexpr std::size_t kHeld = 4;
  const Lattice lattice = Lattice::uniform(30, 48, 1.55, -1.55);
  std::vector<double> held((kHeld + 1) * (kHeld + 1));
  for (double& c : held) c = test::unit(random) - 0.5;
  held[0] = 40;
  const RangeImage image = make_image(lattice, [&](std::size_t row, std::size_t column) {
    if (test::unit(random) < 0.2) return 0.0;  // gaps do not matter
    const auto y =
        real_harmonics(kHeld, std::numbers::pi / 2 - lattice.elevation(static_cast<double>(row)),
                       lattice.azimuth(static_cast<double>(column)));
    double range = 0;
    for (std::size_t k = 0; k < y.size(); ++k) range += held[k] * y[k];
    return range;
  });
  PaperSettings settings = small_settings(1);
  settings.global_degree = 6;
  const PaperStages stages = stages_of(image, settings);
  const GlobalModel model = fit_global(stages, settings, 2, {});
  ASSERT_EQ(model.coefficients.size(), 49u);
  for (std::size_t k = 0; k < model.coefficients.size(); ++k) {
    EXPECT_NEAR(model.coefficients[k], k < held.size() ? held[k] : 0, 1e-6) << k;
  }
  EXPECT_EQ(model.masks.point, stages.masks.point);
  EXPECT_EQ(fit_global(stages, settings, 1, {}).coefficients, model.coefficients);
}

TEST(FitGlobal, MasksCellsThatItCannotFollow) {
  const Lattice lattice = Lattice::uniform(12, 40, 1.2, -1.2);
  const RangeImage image = make_image(lattice, [](std::size_t row, std::size_t column) {
    return row == 5 && column == 9 ? 14.0 : 10.0;
  });
  PaperSettings settings = small_settings(1);
  settings.global_degree = 2;
  const GlobalModel model = fit_global(stages_of(image, settings), settings, 1, {});
  EXPECT_EQ(model.masks.point[model.masks.index(5, 9)], 0);
  EXPECT_EQ(std::count(model.masks.point.begin(), model.masks.point.end(), 0), 1);
  const GlobalField field(model);
  EXPECT_FALSE(field.occupied(5, 9));
  EXPECT_TRUE(std::isnan(evaluated(field, 5, {9}, true)[0]));
  EXPECT_NEAR(evaluated(field, 5, {20}, true)[0], 10, 0.5);
}

TEST(FitGlobal, AnEmptyScanGivesZeros) {
  const RangeImage image =
      make_image(small_lattice(4, 8), [](std::size_t, std::size_t) { return 0.0; });
  PaperSettings settings = small_settings(1);
  settings.global_degree = 3;
  const GlobalModel model = fit_global(stages_of(image, settings), settings, 1, {});
  EXPECT_EQ(model.coefficients, std::vector<double>(16, 0.0));
}

}  // namespace
}  // namespace curlidar
