// SPDX-License-Identifier: BSD-3-Clause
// What the measurements of the report stand on: arguments, splitting rings, judging what is told.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "curlidar/simulate.hpp"
#include "protocol/ring_split.hpp"
#include "report/measure/arguments.hpp"
#include "report/measure/calibrated.hpp"
#include "report/measure/judge.hpp"
#include "report/measure/truth.hpp"

namespace curlidar::bench {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Even rings from +0.2 radians down in steps of 0.05, `height_m` above the origin.
SensorProfile small_sensor(std::size_t rings, double height_m = 0) {
  SensorProfile sensor;
  sensor.name = "small";
  sensor.columns = 64;
  for (std::size_t i = 0; i < rings; ++i) {
    sensor.rings.push_back(
        {.elevation = 0.2 - 0.05 * static_cast<double>(i), .vertical_offset_m = height_m});
  }
  sensor.fov_up = 0.2;
  sensor.fov_down = sensor.rings.back().elevation;
  return sensor;
}

/// A field whose beams start above the origin, everywhere as far away.
class RaisedField final : public Field {
 public:
  static constexpr double kRange_m = 4, kHeight_m = 0.3;
  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double, std::span<const double> columns, bool,
                    std::span<double> ranges) const override {
    for (std::size_t i = 0; i < columns.size(); ++i) ranges[i] = kRange_m;
  }
  void place_row(double row, std::span<const double> columns, std::span<const double> ranges,
                 std::span<Vec3> points) const override {
    Field::place_row(row, columns, ranges, points);
    for (Vec3& p : points) p.z += kHeight_m;
  }
  bool occupied(std::uint32_t, std::uint32_t) const override { return true; }

 private:
  Lattice lattice_ = Lattice::from_rings(small_sensor(9).elevations(), 64);
};

TEST(Arguments, AreWordsAndOptions) {
  const auto arguments = parse_arguments({"a.pcd", "--every", "4"}, 1, {"every"});
  ASSERT_TRUE(arguments);
  EXPECT_EQ(arguments->words, std::vector<std::string>{"a.pcd"});
  EXPECT_EQ(*arguments->number("every", 2, 2, 64), 4u);
  EXPECT_EQ(*arguments->number("runs", 5, 1, 10), 5u);
  EXPECT_FALSE(arguments->number("every", 2, 5, 64));
}

TEST(Arguments, AreRefusedIfTheyMakeNoSense) {
  EXPECT_FALSE(parse_arguments({}, 1, {"every"}));
  EXPECT_FALSE(parse_arguments({"a", "b"}, 1, {"every"}));
  EXPECT_FALSE(parse_arguments({"a", "--every"}, 1, {"every"}));
  EXPECT_FALSE(parse_arguments({"a", "--evry", "4"}, 1, {"every"}));
}

TEST(Factors, AreNumbersBetweenCommas) {
  EXPECT_EQ(*parse_factors("2,4.5,8"), (std::vector<double>{2, 4.5, 8}));
  for (const char* bad : {"", "2,x", "0", "-1", "65", "2,,4"})
    EXPECT_FALSE(parse_factors(bad)) << bad;
}

TEST(FieldSampler, FindsTheBeamThatEndsInADirection) {
  const std::vector<Vec3> directions{direction_of(0.11, 1.234)};
  const auto estimates = FieldSampler(std::make_shared<RaisedField>()).tell(directions);
  ASSERT_EQ(estimates.size(), 1u);
  EXPECT_NEAR(norm(directions[0] * estimates[0].range_m - Vec3{0, 0, RaisedField::kHeight_m}),
              RaisedField::kRange_m, 1e-5);
}

TEST(SplitRings, KeepsEveryNthAndLeavesOutThoseBelowTheLast) {
  const SensorProfile sensor = small_sensor(8);
  Cloud cloud;
  for (const Ring& ring : sensor.rings) {
    cloud.positions.push_back(direction_of(ring.elevation, 0.5) * 7);
  }
  cloud.positions.push_back({0, 0, 0});
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  const Detection detection = assign_rings(cloud, sensor).value();
  const RingSplit split = split_rings(cloud, detection, 3);  // rings 0, 3, 6; ring 7 below
  EXPECT_EQ(split.ring_of_point, (std::vector<std::uint16_t>{0, 1, 2}));
  ASSERT_EQ(split.coded.size(), 3u);
  EXPECT_EQ(split.coded.positions[1], cloud.positions[3]);
  ASSERT_EQ(split.sensor.rings.size(), 3u);
  EXPECT_EQ(split.sensor.rings[2].elevation, sensor.rings[6].elevation);
  EXPECT_EQ(split.held_out.size(), 4u);
  EXPECT_TRUE(validate(split.sensor));
}

RangeEstimate told(double range_m, double confidence = 0.5) {
  return {range_m, static_cast<float>(confidence), Seen::surface};
}

TEST(Judge, CountsWhatIsToldWithinTheLimits) {
  const Judge judge({5.01, 30, kNan, 6, 6, 40}, {1, 10});
  const RayErrors errors = judge.errors(
      std::vector<RangeEstimate>{told(5),   // a good point
                                 told(5),   // the surface is beyond the limits: counts as an error
                                 told(5),   // no surface
                                 {},        // missed
                                 told(12),  // told outside: as good as missed
                                 {}});      // nothing to find there
  EXPECT_EQ(errors.points, 3u);
  EXPECT_EQ(errors.stats.count, 2u);
  EXPECT_NEAR(errors.stats.mean, (0.01 + 25) / 2, 1e-12);
  EXPECT_DOUBLE_EQ(errors.within_5cm, 0.5);
  EXPECT_DOUBLE_EQ(errors.completeness, 1.0 / 3);
  EXPECT_EQ(errors.no_surface, 1u);
}

TEST(Judge, CutsBothMethodsToTheLinesThatTheyTrustMost) {
  const Judge judge({5, 5, 5, 5}, {});
  const std::vector<RangeEstimate> ours{told(5.1, 0.2), told(5.5, 0.1), told(5.2, 0.9),
                                        told(5, 0.3)};
  const std::vector<RangeEstimate> others{{}, told(6, 0.9), told(7, 0.1), told(6, 0.8)};
  const EqualCut cut = judge.equal_cut(ours, others);
  EXPECT_DOUBLE_EQ(cut.completeness, 0.75);
  EXPECT_NEAR(cut.p50, 0.1, 1e-12);
  EXPECT_NEAR(cut.other_p50, 1, 1e-12);
  const Trade half = judge.most_trusted(ours, 0.5);
  EXPECT_DOUBLE_EQ(half.completeness, 0.5);
  EXPECT_NEAR(half.p50, 0.1, 1e-12);  // of 0.2 and 0
  EXPECT_DOUBLE_EQ(half.within_5cm, 0.5);
}

TEST(Judge, RanksWhatTellsNoConfidenceInAnOrderOfItsOwn) {
  std::vector<double> truth;
  std::vector<RangeEstimate> plain, equal;
  for (int i = 0; i < 50; ++i) {
    truth.push_back(5);
    plain.push_back({5.0 + i, std::numeric_limits<float>::quiet_NaN(), Seen::surface});
    equal.push_back(told(5.0 + i));
  }
  const Judge judge(truth, {});
  EXPECT_EQ(judge.ranked(plain), judge.ranked(equal));
  const std::vector<double> ranked = judge.ranked(plain);
  EXPECT_FALSE(std::is_sorted(ranked.begin(), ranked.end()));  // not line by line
}

TEST(Judge, CountsConfidencesInTenBins) {
  const Judge judge({5, 5, kNan, 5}, {});
  const std::vector<RangeEstimate> estimates{
      told(5.01, 0.95), told(5.2, 1), {5, 0.92F, Seen::unknown}, {5, 0.05F, Seen::nothing}};
  const std::vector<ConfidenceBin> bins = judge.confidence(estimates);
  ASSERT_EQ(bins.size(), 10u);
  EXPECT_EQ(bins[9].count, 3u);
  EXPECT_NEAR(bins[9].told, (0.95 + 1 + 0.92) / 3, 1e-6);
  EXPECT_DOUBLE_EQ(bins[9].observed, 1.0 / 3);
  EXPECT_DOUBLE_EQ(bins[0].observed, 1);
  EXPECT_EQ(bins[5].count, 0u);
}

TEST(Judge, TradesCompletenessForPrecision) {
  const Judge judge({5, 5, 5}, {});
  const std::vector<RangeEstimate> estimates{told(5.3, 0.32), told(5.2, 0.61), told(5.1, 0.88)};
  const std::vector<Trade> trades = judge.trades(estimates);
  ASSERT_EQ(trades.size(), 20u);
  EXPECT_DOUBLE_EQ(trades[0].completeness, 1);
  EXPECT_NEAR(trades[0].p50, 0.2, 1e-12);
  EXPECT_DOUBLE_EQ(trades[12].min_confidence, 0.6);
  EXPECT_DOUBLE_EQ(trades[12].completeness, 2.0 / 3);
  EXPECT_DOUBLE_EQ(trades[19].completeness, 0);
}

TEST(SplitRings, AskInTheGapsOfTheHeldOutRings) {
  const SensorProfile sensor = small_sensor(3);
  Cloud cloud;
  for (std::size_t ring = 0; ring < 3; ++ring) {
    for (std::uint32_t column = 0; column < sensor.columns; ++column) {
      const bool missing = ring == 1 && column >= 10 && column < 13;
      const double azimuth = -3 + 6.28318530717958648 * column / sensor.columns;
      cloud.positions.push_back(missing ? Vec3{}
                                        : direction_of(sensor.rings[ring].elevation, azimuth) * 9);
    }
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  const RingSplit split = split_rings(cloud, assign_rings(cloud, sensor).value(), 2);
  EXPECT_EQ(split.held_out.size(), sensor.columns - 3u);
  ASSERT_EQ(split.gaps.size(), 3u);
  for (const Vec3& gap : split.gaps) {
    EXPECT_NEAR(elevation_of(gap), sensor.rings[1].elevation, 1e-9);
    EXPECT_NEAR(norm(gap), 1, 1e-12);
  }
}

TEST(Calibrated, TakesTheMedianErrorOfTheRingFromTheOtherSectors) {
  std::vector<Vec3> returns;
  std::vector<std::uint16_t> rings;
  std::vector<double> true_m;
  std::vector<RangeEstimate> estimates;
  for (int degree = -170; degree < 170; ++degree) {
    returns.push_back(direction_of(0, degree * 0.0174532925) * 10);
    rings.push_back(static_cast<std::uint16_t>(degree & 1));
    true_m.push_back(10);
    estimates.push_back(told(rings.back() == 0 ? 10.03 : 9.98));
  }
  estimates.push_back(told(7));  // a gap
  for (const RangeEstimate& estimate : calibrated(estimates, returns, true_m, rings)) {
    EXPECT_NEAR(estimate.range_m, estimate.range_m > 8 ? 10 : 7, 1e-9);
  }
}

TEST(Methods, AllTellRangesBetweenTheRowsOfARoom) {
  const SensorProfile sensor = small_sensor(16);
  const auto room = make_scene("room").value();
  const Cloud cloud = simulate(*room, sensor).value();
  const Detection rings = assign_rings(cloud, sensor).value();
  EncodeSettings paper;
  paper.profile = Profile::paper;
  paper.paper = paper_preset("indoor").value();
  paper.paper.columns = sensor.columns;
  paper.paper.cliffs = {1, 1, 1.5};
  paper.paper.outlier_radius_m = 0;
  paper.sensor = sensor;
  paper.attributes.emplace();
  const std::vector<Vec3> rays = rays_between(rings, 2, 100'000);
  EXPECT_EQ(rays.size(), 15u * sensor.columns);
  const Judge judge(true_ranges(*room, rays), {});
  for (const Method& method : make_methods({.cloud = &cloud,
                              .paper = paper,
                              .compact_sensor = sensor,
                              .ring_of_point = rings.ring_of_point,
                              .ring_elevations = rings.ring_elevations,
                              .columns = sensor.columns})) {
    SCOPED_TRACE(method.name + " " + method.setting);
    if (!method.sampler) {
      EXPECT_EQ(method.setting, "1 bit a point") << method.skipped;  // too coarse a sensor for it
      continue;
    }
    const RayErrors errors = judge.errors(method.sampler->tell(rays));
    EXPECT_GT(errors.completeness, 0.4);
    EXPECT_LT(errors.stats.p50, method.bytes > 0 && method.step_m > 0 ? 0.4 : 0.1);
  }
}

}  // namespace
}  // namespace curlidar::bench
