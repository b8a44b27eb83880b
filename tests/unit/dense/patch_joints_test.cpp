// SPDX-License-Identifier: BSD-3-Clause
#include "dense/patch_joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "curlidar/field.hpp"
#include "dense/ring_points.hpp"

namespace curlidar {
namespace {

constexpr std::uint32_t kColumns = 64, kPatch = 16;
constexpr double kRange_m = 10, kStep_m = 0.4;

/// One ring in a round room; every other patch of 16 columns was coded `error_m` too far.
class PatchedField final : public Field {
 public:
  /// `turn`: by how much more patches are turned than those before, as where no laser fired.
  explicit PatchedField(double error_m, bool patches = true, double turn = 0) {
    for (std::uint32_t column = 0; column < kColumns; ++column) {
      const std::uint32_t patch = column / kPatch;
      const double range = kRange_m + (patch % 2 == 1 ? error_m : 0);
      points_.push_back(direction_of(0, lattice_.azimuth(column) + turn * patch) * range);
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

std::vector<float> joints(const Field& field) {
  return patch_joints(field, field.cell_points());
}

TEST(PatchJoints, SmoothStepsThatTheCodingMayHaveMade) {
  const PatchedField field(.15);
  const std::vector<Vec3> points = field.cell_points();
  const std::vector<float> moves = joints(field);
  ASSERT_EQ(moves.size(), points.size());
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t next = (i + 1) % points.size();
    const double here = norm(points[i]) + moves[i], there = norm(points[next]) + moves[next];
    largest = std::max(largest, std::abs(there - here));
    EXPECT_GT(here, kRange_m - 1e-6);
    EXPECT_LT(here, kRange_m + .15 + 1e-6);
  }
  EXPECT_LT(largest, .15 / 4 + 1e-6);
  EXPECT_EQ(moves[kPatch / 2], 0);  // middles stay
}

TEST(PatchJoints, MoveTheSamplesOfRings) {
  const PatchedField field(.15);
  const RingPoints points(field);
  const std::vector<float> moves = joints(field);
  for (const RingPoint& p : points.ring(0)) {
    EXPECT_NEAR(p.rho, norm(field.cell_points()[p.cell]) + moves[p.cell], 1e-9);
  }
}

TEST(PatchJoints, LeaveTrueStepsAlone) {
  for (const float move : joints(PatchedField(.25))) EXPECT_EQ(move, 0);
}

TEST(PatchJoints, LeaveGapsOfFiringsAlone) {
  const double column = 2 * std::numbers::pi / kColumns;
  const std::vector<float> beside = joints(PatchedField(.15, true, .5 * column));
  EXPECT_GT(*std::max_element(beside.begin(), beside.end()), .05);
  for (const float move : joints(PatchedField(.15, true, column))) EXPECT_EQ(move, 0);
}

TEST(PatchJoints, NeedPatches) {
  EXPECT_TRUE(joints(PatchedField(.15, false)).empty());
}

}  // namespace
}  // namespace curlidar
