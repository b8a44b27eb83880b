// SPDX-License-Identifier: BSD-3-Clause
// Lines of sight of rings that were held out, and interpolation of samples as these lines see them.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "protocol/held_out_lines.hpp"
#include "report/measure/sampler.hpp"

namespace curlidar::bench {
namespace {

constexpr double kAxis_m = 12;  ///< of a cylinder around the spin axis
constexpr std::uint32_t kColumns = 72;

/// Beams that leave beside and above the axis.
BeamModel beside() {
  BeamModel model;
  for (const double elevation : {0.1, 0.0, -0.1}) {
    model.beams.push_back(
        {.elevation = elevation, .azimuth_offset = 0.02, .height_m = 0.3, .lateral_m = 0.05});
  }
  model.slots = kColumns;
  return model;
}

/// Where a beam at an encoder position hits the cylinder.
Vec3 hit(const BeamModel& model, std::size_t ring, std::uint32_t position) {
  const Beam& beam = model.beams[ring];
  const double ahead = std::sqrt(kAxis_m * kAxis_m - beam.lateral_m * beam.lateral_m);
  return lattice_point(model, ring, position, ahead / std::cos(beam.elevation));
}

RingSplit split_of(const BeamModel& model) {
  RingSplit split;
  for (const std::size_t ring : {0u, 2u}) {
    split.elevations.push_back(model.beams[ring].elevation);
    for (std::uint32_t position = 0; position < kColumns; ++position) {
      split.coded.positions.push_back(hit(model, ring, position));
      split.ring_of_point.push_back(static_cast<std::uint16_t>(ring / 2));
    }
  }
  for (std::uint32_t position = 0; position < kColumns; position += 2) {
    split.held_out.push_back(hit(model, 1, position));
    split.held_out_ring.push_back(1);
  }
  split.gaps = {direction_of(0.01, 1.1)};
  split.gap_ring = {1};
  return split;
}

TEST(HeldOutLines, StartWhereTheBeamPassesTheAxis) {
  const BeamModel model = beside();
  const RingSplit split = split_of(model);
  const AskedLines asked = lines_of(split, &model);
  ASSERT_EQ(asked.lines.size(), split.held_out.size() + 1);
  for (std::size_t i = 0; i < split.held_out.size(); ++i) {
    const Sightline& line = asked.lines[i];
    EXPECT_NEAR(line.origin.z, 0.3, 1e-9);
    EXPECT_NEAR(std::hypot(line.origin.x, line.origin.y), 0.05, 1e-9);
    EXPECT_NEAR(line.direction.z, 0, 1e-9);
    EXPECT_NEAR(line.origin.x * line.direction.x + line.origin.y * line.direction.y, 0, 1e-9);
    const Vec3 end = line.origin + line.direction * asked.true_m[i];
    EXPECT_NEAR(norm(end - split.held_out[i]), 0, 1e-9);
  }
  EXPECT_TRUE(std::isnan(asked.true_m.back()));
  EXPECT_NEAR(azimuth_of(asked.lines.back().direction), 1.1, 1e-9);
  EXPECT_NEAR(asked.lines.back().origin.z, 0.3, 1e-9);
}

TEST(HeldOutLines, StartAtTheOriginWhereNoBeamsAreKnown) {
  const RingSplit split = split_of(beside());
  const AskedLines asked = lines_of(split, nullptr);
  EXPECT_EQ(asked.lines[3].origin, Vec3{});
  EXPECT_NEAR(asked.true_m[3], norm(split.held_out[3]), 1e-9);
}

/// On a cylinder rings of one viewpoint are interpolated to 1 / cos of the elevation between them,
/// whichever way the beams leave.
TEST(RingSampler, InterpolatesAsItsLinesSeeTheSamples) {
  const BeamModel model = beside();
  const RingSplit split = split_of(model);
  const auto rings = std::make_shared<const SampledRings>(
      SampledRings{split.coded.positions, split.ring_of_point, split.elevations, kColumns});
  const AskedLines asked = lines_of(split, &model);
  const auto told = RingSampler(rings, Mixing::edge_aware).along(asked.lines);
  const double ahead = std::sqrt(kAxis_m * kAxis_m - 0.05 * 0.05);
  for (std::size_t i = 0; i < split.held_out.size(); ++i) {
    ASSERT_TRUE(told[i].valid()) << i;
    EXPECT_NEAR(told[i].range_m, ahead / std::cos(0.1), 1e-9);
  }
}

TEST(RingSampler, CountsRangesFromWhereALineStarts) {
  const BeamModel model = beside();
  const RingSplit split = split_of(model);
  const auto rings = std::make_shared<const SampledRings>(
      SampledRings{split.coded.positions, split.ring_of_point, split.elevations, kColumns});
  const RingSampler sampler(rings, Mixing::linear);
  Sightline line = lines_of(split, &model).lines[5];
  const double from_axis = sampler.along(std::vector{line})[0].range_m;
  line.origin = line.origin + line.direction * 0.7;
  EXPECT_NEAR(sampler.along(std::vector{line})[0].range_m, from_axis - 0.7, 1e-9);
}

}  // namespace
}  // namespace curlidar::bench
