// SPDX-License-Identifier: BSD-3-Clause
// Between the samples of decoded files: simulated rooms and streets whose surfaces are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "curlidar/codec.hpp"
#include "curlidar/dense.hpp"
#include "curlidar/simulate.hpp"

namespace curlidar {
namespace {

struct Coded {
  std::shared_ptr<const Scene> scene;
  DecodedScan scan;
};

Coded coded(const std::string& scene, SensorProfile sensor, EncodeSettings settings,
            bool beam_origins = false) {
  Coded coded;
  coded.scene = make_scene(scene, 1).value();
  const Cloud cloud =
      simulate(*coded.scene, sensor, {.beam_origins = beam_origins, .seed = 1}).value();
  settings.sensor = std::move(sensor);
  settings.attributes.emplace();
  const Encoded encoded = encode(cloud, settings).value();
  coded.scan = decode(encoded.bytes, {.partition = true}).value();
  return coded;
}

SensorProfile sensor(const std::string& name, std::uint32_t columns) {
  SensorProfile sensor = builtin_sensor(name).value();
  sensor.columns = columns;
  return sensor;
}

EncodeSettings compact(CompactTarget target, double value) {
  EncodeSettings settings;
  settings.compact.target = target;
  settings.compact.effort = 1;
  settings.compact.target_value = value;
  return settings;
}

double range_to(const Scene& scene, const Vec3& origin, const Vec3& direction) {
  Hit hit;
  return scene.cast(origin, direction, hit) ? hit.range_m
                                            : std::numeric_limits<double>::quiet_NaN();
}

struct Reached {
  double completeness = 0, p50 = 0, p95 = 0;
};

/// Lines between the rings, from a height over the origin.
Reached between_the_rings(const Coded& coded, const Field& field, double height_m) {
  std::vector<Sightline> lines;
  const std::vector<double>& elevations = field.lattice().elevations();
  for (std::size_t row = 0; row + 1 < elevations.size(); ++row) {
    for (int k = 0; k < 400; ++k) {
      const double share = .05 + .9 * std::fmod(.37 * k, 1.0);
      const double up = elevations[row] + (elevations[row + 1] - elevations[row]) * share;
      lines.push_back({{0, 0, height_m}, direction_of(up, std::numbers::pi * (k / 200.0 - 1))});
    }
  }
  std::vector<RangeEstimate> told(lines.size());
  field.range_along(lines, told);
  std::vector<double> errors;
  std::size_t wanted = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double truth = range_to(*coded.scene, lines[i].origin, lines[i].direction);
    if (!(truth < 50)) continue;
    ++wanted;
    if (told[i].valid()) errors.push_back(std::abs(told[i].range_m - truth));
  }
  Reached result;
  result.completeness = static_cast<double>(errors.size()) / static_cast<double>(wanted);
  result.p50 = percentile(errors, .5);
  result.p95 = percentile(errors, .95);
  return result;
}

TEST(DenseDecoded, FindsTheWallsOfARoom) {
  const Coded room = coded("room", sensor("os1-64", 512), compact(CompactTarget::error, .01));
  const Reached plain = between_the_rings(room, *dense_field(room.scan.field), 0);
  EXPECT_GT(plain.completeness, .99);
  EXPECT_LT(plain.p50, .015);
  EXPECT_LT(plain.p95, .1);
}

TEST(DenseDecoded, FindsThemForBeamsThatStartElsewhere) {
  const Coded room =
      coded("room", sensor("hdl64e-kitti", 512), compact(CompactTarget::error, .01), true);
  const auto field = dense_field(room.scan.field);
  const Reached raised = between_the_rings(room, *field, .15);
  EXPECT_LT(raised.p50, .02);
  EXPECT_GT(raised.completeness, .95);
}

TEST(DenseDecoded, TellsMoreOfAPaperFileAndTheSameOnItsCells) {
  EncodeSettings settings;
  settings.profile = Profile::paper;
  settings.paper = paper_preset("indoor").value();
  settings.paper.columns = 256;
  const Coded room = coded("room", sensor("vlp16", 512), settings);
  const auto field = dense_field(room.scan.field);
  EXPECT_GT(between_the_rings(room, *field, 0).completeness,
            between_the_rings(room, *room.scan.field, 0).completeness);
  const std::vector<double> columns{0, 17, 100, 255};
  std::vector<double> told(4), paper(4);
  std::size_t cells = 0;
  for (std::uint32_t row = 0; row < field->lattice().rows(); row += 3) {
    field->evaluate_row(row, columns, true, told);
    room.scan.field->evaluate_row(row, columns, true, paper);
    for (std::size_t i = 0; i < 4; ++i) {
      if (!field->occupied(row, static_cast<std::uint32_t>(columns[i]))) continue;
      EXPECT_NEAR(told[i], paper[i], 1e-6) << row << ' ' << columns[i];
      ++cells;
    }
  }
  EXPECT_GT(cells, 10u);
}

/// Whether the scene is one surface all around a border between cells.
bool one_surface(const Scene& scene, const Lattice& lattice, double row, double column) {
  double nearest = 1e9, farthest = 0;
  for (const double up : {-1, 0, 1, 2}) {
    for (const double aside : {-1.5, -.5, .5, 1.5}) {
      const double truth = range_to(scene, {}, lattice.direction(row + up, column + aside));
      nearest = std::min(nearest, truth);
      farthest = std::isnan(truth) ? 1e9 : std::max(farthest, truth);
    }
  }
  return farthest <= 1.1 * nearest + .3;
}

/// By how much the told range changes more than the true one from left to right of a border.
double step_over(const Coded& coded, const Field& field, double row, double column, double aside) {
  const std::array directions{field.lattice().direction(row, column - aside),
                              field.lattice().direction(row, column + aside)};
  std::array<RangeEstimate, 2> told;
  field.range_at(directions, told);
  const double truly =
      range_to(*coded.scene, {}, directions[1]) - range_to(*coded.scene, {}, directions[0]);
  const double step = std::abs(told[1].range_m - told[0].range_m - truly);
  return told[0].valid() && told[1].valid() ? step : 0;
}

TEST(DenseDecoded, HasNoStepsBetweenPatches) {
  const Coded street =
      coded("street", sensor("os1-64", 512), compact(CompactTarget::bits_per_point, 1));
  const auto field = dense_field(street.scan.field);
  const double step = street.scan.compact->step_m;
  std::vector<double> at_border, cell_to_cell;
  for (const CompactLeaf& leaf : street.scan.compact->leaves) {
    const double column = leaf.column - .5;
    for (std::uint32_t row = leaf.row + 1; row + 2 < leaf.row + leaf.rows; ++row) {
      if (!one_surface(*street.scene, field->lattice(), row, column)) continue;
      at_border.push_back(step_over(street, *field, row + .4, column, .02));
      cell_to_cell.push_back(step_over(street, *field, row + .4, column, .5));
    }
  }
  ASSERT_GT(at_border.size(), 500u);
  const auto mean = [](const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  };
  EXPECT_LT(mean(at_border), step / 20);
  EXPECT_LT(*std::max_element(at_border.begin(), at_border.end()), 2 * step);
  EXPECT_LT(mean(cell_to_cell), step / 4);
}

}  // namespace
}  // namespace curlidar
