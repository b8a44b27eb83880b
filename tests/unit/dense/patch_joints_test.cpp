// SPDX-License-Identifier: BSD-3-Clause
#include "dense/patch_joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "unit/dense/ring_field.hpp"

namespace curlidar {
namespace {

constexpr std::uint32_t kColumns = 64, kPatch = 16;
constexpr double kRange_m = 10, kStep_m = 0.4;

/// One ring in a round room; every other patch of 16 columns was coded `error_m` too far.
class PatchedField final : public Field {
 public:
  explicit PatchedField(double error_m, bool patches = true) {
    for (std::uint32_t column = 0; column < kColumns; ++column) {
      const std::uint32_t patch = column / kPatch;
      const double range = kRange_m + (patch % 2 == 1 ? error_m : 0);
      points_.push_back(direction_of(0, lattice_.azimuth(column)) * range);
      if (patches) patches_.push_back(static_cast<std::int32_t>(patch));
    }
  }

  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double, std::span<const double>, bool, std::span<double>) const override {}
  bool occupied(std::uint32_t, std::uint32_t) const override { return true; }
  std::vector<Vec3> cell_points() const override { return points_; }
  std::vector<std::int32_t> cell_patches() const override { return patches_; }
  double step_m() const override { return kStep_m; }

 private:
  Lattice lattice_ = Lattice::from_rings({0}, kColumns);
  std::vector<Vec3> points_;
  std::vector<std::int32_t> patches_;
};

double largest_step(const std::vector<Vec3>& points) {
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double here = norm(points[i]), next = norm(points[(i + 1) % points.size()]);
    largest = std::max(largest, std::abs(next - here));
  }
  return largest;
}

TEST(PatchJoints, SmoothStepsThatTheCodingMayHaveMade) {
  const std::vector<Vec3> points = joined_points(PatchedField(.15));
  EXPECT_LT(largest_step(points), .15 / 4 + 1e-9);
  EXPECT_NEAR(norm(points[kPatch / 2]), kRange_m, 1e-12);  // middles stay
  for (const Vec3& p : points) {
    EXPECT_GT(norm(p), kRange_m - 1e-9);
    EXPECT_LT(norm(p), kRange_m + .15 + 1e-9);
  }
}

TEST(PatchJoints, LeaveTrueStepsAlone) {
  const PatchedField field(.25);
  EXPECT_EQ(joined_points(field), field.cell_points());
}

TEST(PatchJoints, NeedPatches) {
  const PatchedField field(.15, false);
  EXPECT_EQ(joined_points(field), field.cell_points());
}

}  // namespace
}  // namespace curlidar
