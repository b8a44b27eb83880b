// SPDX-License-Identifier: BSD-3-Clause
// Whoever asks a decoded file, in whatever way, is told of one and the same surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "curlidar/codec.hpp"
#include "curlidar/dense.hpp"
#include "curlidar/io.hpp"
#include "curlidar/simulate.hpp"
#include "dense/patch_joints.hpp"
#include "support/data.hpp"

namespace curlidar {
namespace {

/// A decoded file, asked by itself and between its samples.
struct Asked {
  std::shared_ptr<const Field> plain, dense;
};

Asked coded(const Cloud& cloud) {
  EncodeSettings settings;
  settings.compact.target = CompactTarget::error;
  settings.compact.target_value = .05;
  settings.compact.effort = 1;
  settings.attributes.emplace();
  const auto field = decode(encode(cloud, settings).value().bytes).value().field;
  return {field, dense_field(field)};
}

/// A simulated scan of beams that start beside the spin axis; null where there is no such.
std::optional<Cloud> cloud_of(const std::string& name) {
  if (name == "simulated") {
    SensorProfile sensor = builtin_sensor("hdl64e-kitti").value();
    sensor.columns = 1024;
    return simulate(*make_scene("street", 1).value(), sensor, {.beam_origins = true, .seed = 1})
        .value();
  }
  const auto data = test::data_directory();
  if (!data) return std::nullopt;
  return read_cloud((*data / name).string()).value();
}

/// The line of the own frame as the cloud's frame has it.
Sightline moved(const Field& field, double azimuth, const Vec3& from, const Vec3& along) {
  const RigidMotion motion = field.motion_at(azimuth);
  return {motion(from), motion.turned(along)};
}

/// A coded return, and the line from its beam's start on the spin axis through it.
struct CodedReturn {
  std::size_t cell = 0;
  std::uint32_t row = 0;
  double azimuth = 0, range_m = 0;
  Sightline line;
};

std::vector<CodedReturn> coded_returns(const Field& field) {
  const std::vector<Vec3> points = field.cell_points();
  std::vector<CodedReturn> returns;
  for (std::size_t cell = 0; cell < points.size(); ++cell) {
    if (std::isnan(points[cell].x)) continue;
    const auto row = static_cast<std::uint32_t>(cell / field.lattice().columns());
    const Vec3 from{0, 0, field.row_line(row).height_m}, along = points[cell] - from;
    const double azimuth = azimuth_of(points[cell]);
    returns.push_back({cell, row, azimuth, norm(along), moved(field, azimuth, from, along)});
  }
  return returns;
}

std::vector<RangeEstimate> told_along(const Field& field, const std::vector<CodedReturn>& returns) {
  std::vector<Sightline> lines;
  for (const CodedReturn& each : returns) lines.push_back(each.line);
  std::vector<RangeEstimate> told(lines.size());
  field.range_along(lines, told);
  return told;
}

class DenseOneSurface : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const auto cloud = cloud_of(GetParam());
    if (!cloud) GTEST_SKIP() << "no " << GetParam() << " here";
    static std::string name;
    static Asked last;
    if (name != GetParam()) last = coded(*cloud);
    name = GetParam();
    asked_ = last;
  }
  const Field& plain() const { return *asked_.plain; }
  const Field& dense() const { return *asked_.dense; }
  double joint_m(const CodedReturn& each) {
    if (!joints_) joints_ = patch_joints(plain(), plain().cell_points());
    return (*joints_)[each.cell];
  }

 private:
  Asked asked_;
  std::optional<std::vector<float>> joints_;
};

TEST_P(DenseOneSurface, CellsOfRaysDoNotLieOnTheColumns) {
  double beside = 0;
  for (const CodedReturn& each : coded_returns(plain())) {
    const auto column = static_cast<double>(each.cell % plain().lattice().columns());
    const double turn = each.azimuth - plain().lattice().azimuth(column);
    beside = std::max(beside, std::abs(std::remainder(turn, 2 * std::numbers::pi)));
  }
  EXPECT_GT(beside, 2 * std::numbers::pi / plain().lattice().columns());
}

TEST_P(DenseOneSurface, PassesThroughEveryReturnAsItsOwnBeamSawIt) {
  // Lines of rows leave out that beams pass beside the axis: they look up to 1e-5 rad beside.
  constexpr double kSame_m = .002, kAlmost_m = .01;
  const std::vector<CodedReturn> returns = coded_returns(plain());
  const std::vector<RangeEstimate> told = told_along(dense(), returns);
  std::size_t elsewhere = 0, elsewhere_on_row = 0;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const CodedReturn& each = returns[i];
    const double wanted = each.range_m + joint_m(each);
    ASSERT_TRUE(told[i].valid()) << each.row << ' ' << each.azimuth;
    elsewhere += std::abs(told[i].range_m - wanted) < kSame_m ? 0 : 1;
    const double column = plain().lattice().column_of(each.azimuth);
    double range = 0;
    dense().evaluate_row(each.row, std::span(&column, 1), true, std::span(&range, 1));
    elsewhere_on_row += std::abs(range - wanted) < kAlmost_m ? 0 : 1;
  }
  EXPECT_EQ(elsewhere, 0u);
  EXPECT_EQ(elsewhere_on_row, 0u);
}

TEST_P(DenseOneSurface, RowsSayWhatLinesSay) {
  const double columns = dense().lattice().columns();
  std::size_t seen = 0, asked = 0, other = 0;
  for (double row = -.3; row < dense().lattice().rows() - .6; row += .7) {
    const RowLine line = dense().row_line(row);
    for (double column = .4; column < columns; column += 7.3) {
      const double azimuth = dense().lattice().azimuth(column);
      const Sightline sight =
          moved(dense(), azimuth, {0, 0, line.height_m}, direction_of(line.elevation, azimuth));
      RangeEstimate told;
      dense().range_along(std::span(&sight, 1), std::span(&told, 1));
      double range = 0;
      dense().evaluate_row(row, std::span(&column, 1), true, std::span(&range, 1));
      const bool same =
          told.valid() ? std::abs(told.range_m - range) < 1e-5 * range : std::isnan(range);
      ++asked;
      seen += told.valid() ? 1 : 0;
      other += same ? 0 : 1;
    }
  }
  EXPECT_GT(seen, asked / 2);
  EXPECT_EQ(other, 0u);
}

/// Steps over borders of patches that lie beside each other in a row, less the slopes on both
/// sides. `range_m`: of each of `returns`.
std::vector<double> steps_at_borders(const Field& field, const std::vector<CodedReturn>& returns,
                                     const std::vector<double>& range_m) {
  const std::vector<std::int32_t> patch = field.cell_patches();
  std::vector<double> steps;
  for (std::size_t i = 1; i + 2 < returns.size(); ++i) {
    const auto cell = [&](std::size_t at) { return returns[at].cell; };
    const bool beside = cell(i + 2) == cell(i - 1) + 3 && returns[i + 2].row == returns[i - 1].row;
    const bool border = patch[cell(i - 1)] == patch[cell(i)] &&
                        patch[cell(i)] != patch[cell(i + 1)] &&
                        patch[cell(i + 1)] == patch[cell(i + 2)];
    if (!beside || !border) continue;
    const double slopes = range_m[i] - range_m[i - 1] + range_m[i + 2] - range_m[i + 1];
    steps.push_back(std::abs(range_m[i + 1] - range_m[i] - slopes / 2));
  }
  return steps;
}

TEST_P(DenseOneSurface, JointsShrinkTheStepsBetweenPatchesWhereTheirCellsLook) {
  const std::vector<CodedReturn> returns = coded_returns(plain());
  std::vector<double> coded, told;
  for (const CodedReturn& each : returns) {
    const double column = plain().lattice().column_of(each.azimuth);
    double range = 0;
    dense().evaluate_row(each.row, std::span(&column, 1), true, std::span(&range, 1));
    coded.push_back(each.range_m);
    told.push_back(range);
  }
  const double most = plain().step_m() / 2;  // that the coding may have made
  const std::vector<double> before = steps_at_borders(plain(), returns, coded);
  const std::vector<double> after = steps_at_borders(plain(), returns, told);
  double sum_before = 0, sum_after = 0;
  std::size_t borders = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i] > most) continue;
    ++borders;
    sum_before += before[i];
    sum_after += after[i];
  }
  // Where only one firing in four returns, as in the simulation, no cells lie beside each other.
  if (GetParam() != "simulated") {
    ASSERT_GT(borders, 1000u);
  }
  EXPECT_LE(sum_after, .35 * sum_before);
}

INSTANTIATE_TEST_SUITE_P(Rays, DenseOneSurface,
                         ::testing::Values("simulated", "kitti_object/000000.bin"));

}  // namespace
}  // namespace curlidar
